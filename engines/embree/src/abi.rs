//! Where versions 3 and 4 differ: how rays are handed over, and the flags that go with them.

use std::ffi::{c_int, c_uint, c_void};
use std::ptr::null_mut;

use crate::api::{Handle, INVALID_ID, RtcRay, RtcRayHit, RtcRayHits, RtcRays, symbols};

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
    /// As for [`Self::intersect1`]; `N` is 8 or 16. Rays whose `valid` isn't -1 are left alone.
    unsafe fn intersect<const N: usize>(&self, valid: &Valid<N>, scene: Handle, rays: &mut RtcRayHits<N>);

    /// # Safety
    /// As for [`Self::intersect`].
    unsafe fn occluded<const N: usize>(&self, valid: &Valid<N>, scene: Handle, rays: &mut RtcRays<N>);
}

/// Which rays of a packet count: -1 for those that do, else 0.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct Valid<const N: usize>(pub(crate) [c_int; N]);

symbols! {
    /// Version 4: options come last, and may be null.
    Four {
        intersect1 = "rtcIntersect1": unsafe extern "C" fn(Handle, *mut RtcRayHit, *mut Arguments);
        occluded1 = "rtcOccluded1": unsafe extern "C" fn(Handle, *mut RtcRay, *mut Arguments);
        intersect8 = "rtcIntersect8": unsafe extern "C" fn(*const Valid<8>, Handle, *mut RtcRayHits<8>, *mut Arguments);
        occluded8 = "rtcOccluded8": unsafe extern "C" fn(*const Valid<8>, Handle, *mut RtcRays<8>, *mut Arguments);
        intersect16 = "rtcIntersect16":
            unsafe extern "C" fn(*const Valid<16>, Handle, *mut RtcRayHits<16>, *mut Arguments);
        occluded16 = "rtcOccluded16": unsafe extern "C" fn(*const Valid<16>, Handle, *mut RtcRays<16>, *mut Arguments);
    }
}

symbols! {
    /// Version 3: a context stands between scene and ray.
    Three {
        intersect1 = "rtcIntersect1": unsafe extern "C" fn(Handle, *mut Context, *mut RtcRayHit);
        occluded1 = "rtcOccluded1": unsafe extern "C" fn(Handle, *mut Context, *mut RtcRay);
        intersect8 = "rtcIntersect8": unsafe extern "C" fn(*const Valid<8>, Handle, *mut Context, *mut RtcRayHits<8>);
        occluded8 = "rtcOccluded8": unsafe extern "C" fn(*const Valid<8>, Handle, *mut Context, *mut RtcRays<8>);
        intersect16 = "rtcIntersect16":
            unsafe extern "C" fn(*const Valid<16>, Handle, *mut Context, *mut RtcRayHits<16>);
        occluded16 = "rtcOccluded16": unsafe extern "C" fn(*const Valid<16>, Handle, *mut Context, *mut RtcRays<16>);
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
    unsafe fn intersect<const N: usize>(&self, valid: &Valid<N>, scene: Handle, rays: &mut RtcRayHits<N>) {
        const { assert!(N == 8 || N == 16, "no such packets") }
        let (valid, rays) = (std::ptr::from_ref(valid), std::ptr::from_mut(rays));
        // SAFETY: scene and rays are as the caller promises, and `N` is what the call takes; the options are the documented ones.
        unsafe {
            if N == 8 {
                (self.intersect8)(valid.cast(), scene, rays.cast(), &mut Arguments::coherent());
            } else {
                (self.intersect16)(valid.cast(), scene, rays.cast(), &mut Arguments::coherent());
            }
        }
    }

    #[inline(always)]
    unsafe fn occluded<const N: usize>(&self, valid: &Valid<N>, scene: Handle, rays: &mut RtcRays<N>) {
        const { assert!(N == 8 || N == 16, "no such packets") }
        let (valid, rays) = (std::ptr::from_ref(valid), std::ptr::from_mut(rays));
        // SAFETY: scene and rays are as the caller promises, and `N` is what the call takes; the options are the documented ones.
        unsafe {
            if N == 8 {
                (self.occluded8)(valid.cast(), scene, rays.cast(), &mut Arguments::coherent());
            } else {
                (self.occluded16)(valid.cast(), scene, rays.cast(), &mut Arguments::coherent());
            }
        }
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
    unsafe fn intersect<const N: usize>(&self, valid: &Valid<N>, scene: Handle, rays: &mut RtcRayHits<N>) {
        const { assert!(N == 8 || N == 16, "no such packets") }
        let (valid, rays) = (std::ptr::from_ref(valid), std::ptr::from_mut(rays));
        // SAFETY: scene and rays are as the caller promises, and `N` is what the call takes; the options are the documented ones.
        unsafe {
            if N == 8 {
                (self.intersect8)(valid.cast(), scene, &mut Context::coherent(), rays.cast());
            } else {
                (self.intersect16)(valid.cast(), scene, &mut Context::coherent(), rays.cast());
            }
        }
    }

    #[inline(always)]
    unsafe fn occluded<const N: usize>(&self, valid: &Valid<N>, scene: Handle, rays: &mut RtcRays<N>) {
        const { assert!(N == 8 || N == 16, "no such packets") }
        let (valid, rays) = (std::ptr::from_ref(valid), std::ptr::from_mut(rays));
        // SAFETY: scene and rays are as the caller promises, and `N` is what the call takes; the options are the documented ones.
        unsafe {
            if N == 8 {
                (self.occluded8)(valid.cast(), scene, &mut Context::coherent(), rays.cast());
            } else {
                (self.occluded16)(valid.cast(), scene, &mut Context::coherent(), rays.cast());
            }
        }
    }
}
