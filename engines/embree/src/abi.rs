//! Where versions 3 and 4 differ: how rays are handed over, and the flags that go with them.

use std::ffi::{c_int, c_uint, c_void};
use std::ptr::null_mut;

use crate::api::{Handle, INVALID_ID, RtcRay, RtcRay16, RtcRayHit, RtcRayHit16, symbols};

/// A version's own calls. The structures are those of version 4; version 3 uses the first part of each.
pub(crate) trait Abi: Sized + Copy {
    /// The version's number.
    const MAJOR: isize;
    /// The name of the competitor.
    const NAME: &'static str;
    /// The library's file name begins so.
    const STEM: &'static str;
    /// The library's name for the system's loader.
    const SONAME: &'static str;
    /// The variable that names its folder.
    const VARIABLE: &'static str;
    /// Its folder beside the folder of the programs.
    const FOLDER: &'static str;

    /// Looks up the version's calls.
    ///
    /// # Errors
    /// The library lacks one.
    fn find(library: &libloading::Library) -> Result<Self, libloading::Error>;

    /// # Safety
    /// The scene is committed; the ray has the layout and alignment of its type.
    unsafe fn intersect1(&self, scene: Handle, ray: &mut RtcRayHit);

    /// # Safety
    /// As for [`Self::intersect1`].
    unsafe fn occluded1(&self, scene: Handle, ray: &mut RtcRay);

    /// # Safety
    /// As for [`Self::intersect1`]; rays whose `valid` isn't -1 are left alone.
    unsafe fn intersect16(&self, valid: &Valid, scene: Handle, rays: &mut RtcRayHit16);

    /// # Safety
    /// As for [`Self::intersect16`].
    unsafe fn occluded16(&self, valid: &Valid, scene: Handle, rays: &mut RtcRay16);
}

/// Which rays of a packet count: -1 for those that do, else 0.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Valid(pub(crate) [c_int; 16]);

symbols! {
    /// Version 4: options come last, and may be null.
    Four {
        intersect1 = "rtcIntersect1": unsafe extern "C" fn(Handle, *mut RtcRayHit, *mut Arguments);
        occluded1 = "rtcOccluded1": unsafe extern "C" fn(Handle, *mut RtcRay, *mut Arguments);
        intersect16 = "rtcIntersect16": unsafe extern "C" fn(*const Valid, Handle, *mut RtcRayHit16, *mut Arguments);
        occluded16 = "rtcOccluded16": unsafe extern "C" fn(*const Valid, Handle, *mut RtcRay16, *mut Arguments);
    }
}

symbols! {
    /// Version 3: a context stands between scene and ray.
    Three {
        intersect1 = "rtcIntersect1": unsafe extern "C" fn(Handle, *mut Context, *mut RtcRayHit);
        occluded1 = "rtcOccluded1": unsafe extern "C" fn(Handle, *mut Context, *mut RtcRay);
        intersect16 = "rtcIntersect16": unsafe extern "C" fn(*const Valid, Handle, *mut Context, *mut RtcRayHit16);
        occluded16 = "rtcOccluded16": unsafe extern "C" fn(*const Valid, Handle, *mut Context, *mut RtcRay16);
    }
}

/// `RTCIntersectArguments` and `RTCOccludedArguments` of version 4.
#[repr(C)]
pub(crate) struct Arguments {
    flags: c_uint,
    features: c_uint,
    context: *mut c_void,
    filter: *mut c_void,
    intersect: *mut c_void,
    /// Only in libraries that were compiled for it; harmless in others.
    min_width_distance_factor: f32,
}

/// `RTCIntersectContext` of version 3.
#[repr(C)]
pub(crate) struct Context {
    flags: c_uint,
    filter: *mut c_void,
    instance: [c_uint; 1],
    min_width_distance_factor: f32,
}

impl Arguments {
    fn coherent() -> Self {
        Self {
            flags: 1 << 16,
            features: c_uint::MAX,
            context: null_mut(),
            filter: null_mut(),
            intersect: null_mut(),
            min_width_distance_factor: 0.0,
        }
    }
}

impl Context {
    fn new(flags: c_uint) -> Self {
        Self { flags, filter: null_mut(), instance: [INVALID_ID], min_width_distance_factor: 0.0 }
    }

    fn incoherent() -> Self {
        Self::new(0)
    }

    fn coherent() -> Self {
        Self::new(1)
    }
}

impl Abi for Four {
    const MAJOR: isize = 4;
    const NAME: &'static str = "embree4";
    const STEM: &'static str = "libembree4";
    const SONAME: &'static str = "libembree4.so.4";
    const VARIABLE: &'static str = "EMBREE_LIB";
    const FOLDER: &'static str = "embreex.libs";

    fn find(library: &libloading::Library) -> Result<Self, libloading::Error> {
        Self::look_up(library)
    }

    #[inline(always)]
    unsafe fn intersect1(&self, scene: Handle, ray: &mut RtcRayHit) {
        // SAFETY: scene and ray are as the caller promises; null stands for the default arguments.
        unsafe { (self.intersect1)(scene, ray, null_mut()) }
    }

    #[inline(always)]
    unsafe fn occluded1(&self, scene: Handle, ray: &mut RtcRay) {
        // SAFETY: as for `intersect1`.
        unsafe { (self.occluded1)(scene, ray, null_mut()) }
    }

    #[inline(always)]
    unsafe fn intersect16(&self, valid: &Valid, scene: Handle, rays: &mut RtcRayHit16) {
        // SAFETY: scene and rays are as the caller promises; the arguments are those of `rtcInitIntersectArguments`.
        unsafe { (self.intersect16)(valid, scene, rays, &mut Arguments::coherent()) }
    }

    #[inline(always)]
    unsafe fn occluded16(&self, valid: &Valid, scene: Handle, rays: &mut RtcRay16) {
        // SAFETY: as for `intersect16`.
        unsafe { (self.occluded16)(valid, scene, rays, &mut Arguments::coherent()) }
    }
}

impl Abi for Three {
    const MAJOR: isize = 3;
    const NAME: &'static str = "embree3";
    const STEM: &'static str = "libembree3";
    const SONAME: &'static str = "libembree3.so.3";
    const VARIABLE: &'static str = "EMBREE3_LIB";
    const FOLDER: &'static str = "embree3/usr/lib/x86_64-linux-gnu";

    fn find(library: &libloading::Library) -> Result<Self, libloading::Error> {
        Self::look_up(library)
    }

    #[inline(always)]
    unsafe fn intersect1(&self, scene: Handle, ray: &mut RtcRayHit) {
        // SAFETY: scene and ray are as the caller promises; the context is that of `rtcInitIntersectContext`.
        unsafe { (self.intersect1)(scene, &mut Context::incoherent(), ray) }
    }

    #[inline(always)]
    unsafe fn occluded1(&self, scene: Handle, ray: &mut RtcRay) {
        // SAFETY: as for `intersect1`.
        unsafe { (self.occluded1)(scene, &mut Context::incoherent(), ray) }
    }

    #[inline(always)]
    unsafe fn intersect16(&self, valid: &Valid, scene: Handle, rays: &mut RtcRayHit16) {
        // SAFETY: as for `intersect1`.
        unsafe { (self.intersect16)(valid, scene, &mut Context::coherent(), rays) }
    }

    #[inline(always)]
    unsafe fn occluded16(&self, valid: &Valid, scene: Handle, rays: &mut RtcRay16) {
        // SAFETY: as for `intersect1`.
        unsafe { (self.occluded16)(valid, scene, &mut Context::coherent(), rays) }
    }
}
