//! Embree's C interface, as far as it is used and the same in versions 3 and 4: declared here from its documentation,
//! since the libraries that are easy to get come without headers.

use std::ffi::{c_char, c_int, c_uint, c_void};

/// A device, scene or geometry.
pub(crate) type Handle = *mut c_void;

/// No geometry: a miss.
pub(crate) const INVALID_ID: c_uint = c_uint::MAX;

pub(crate) const DEVICE_PROPERTY_VERSION: c_int = 0;
/// Whether packets of sixteen are traced as such, not ray by ray.
pub(crate) const DEVICE_PROPERTY_NATIVE_RAY16: c_int = 34;
pub(crate) const GEOMETRY_TYPE_TRIANGLE: c_int = 0;
pub(crate) const BUFFER_TYPE_INDEX: c_int = 0;
pub(crate) const BUFFER_TYPE_VERTEX: c_int = 1;
pub(crate) const FORMAT_UINT3: c_int = 0x5003;
pub(crate) const FORMAT_FLOAT3: c_int = 0x9003;
pub(crate) const SCENE_FLAG_ROBUST: c_int = 1 << 2;
pub(crate) const BUILD_QUALITY_MEDIUM: c_int = 1;
pub(crate) const BUILD_QUALITY_HIGH: c_int = 2;

/// `RTCRay`.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct RtcRay {
    pub(crate) origin: [f32; 3],
    pub(crate) t_near: f32,
    pub(crate) direction: [f32; 3],
    pub(crate) time: f32,
    /// Shortened to the hit; negative infinity where an occlusion was found.
    pub(crate) t_far: f32,
    pub(crate) mask: c_uint,
    pub(crate) id: c_uint,
    pub(crate) flags: c_uint,
}

/// `RTCHit` of version 4, compiled with one instance level and instance arrays. Version 3 knows all but the last field.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct RtcHit {
    pub(crate) normal: [f32; 3],
    pub(crate) u: f32,
    pub(crate) v: f32,
    pub(crate) primitive: c_uint,
    pub(crate) geometry: c_uint,
    pub(crate) instance: [c_uint; 1],
    /// Without instance arrays this field is absent; the structure's size is the same, because of its alignment.
    pub(crate) instance_primitive: [c_uint; 1],
}

/// `RTCRayHit`.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(16))]
pub(crate) struct RtcRayHit {
    pub(crate) ray: RtcRay,
    pub(crate) hit: RtcHit,
}

/// `RTCRay8` or `RTCRay16`.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct RtcRays<const N: usize> {
    pub(crate) origin: [[f32; N]; 3],
    pub(crate) t_near: [f32; N],
    pub(crate) direction: [[f32; N]; 3],
    pub(crate) time: [f32; N],
    pub(crate) t_far: [f32; N],
    pub(crate) mask: [c_uint; N],
    pub(crate) id: [c_uint; N],
    pub(crate) flags: [c_uint; N],
}

/// `RTCHit8` or `RTCHit16`, with the last field for libraries with instance arrays: they write it.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct RtcHits<const N: usize> {
    pub(crate) normal: [[f32; N]; 3],
    pub(crate) u: [f32; N],
    pub(crate) v: [f32; N],
    pub(crate) primitive: [c_uint; N],
    pub(crate) geometry: [c_uint; N],
    pub(crate) instance: [[c_uint; N]; 1],
    pub(crate) instance_primitive: [[c_uint; N]; 1],
}

/// `RTCRayHit8` or `RTCRayHit16`.
#[derive(Debug, Clone, Copy)]
#[repr(C, align(64))]
pub(crate) struct RtcRayHits<const N: usize> {
    pub(crate) ray: RtcRays<N>,
    pub(crate) hit: RtcHits<N>,
}

const _: () = assert!(size_of::<RtcRay>() == 48 && size_of::<RtcRayHit>() == 96);
const _: () = assert!(size_of::<RtcRays<16>>() == 768 && size_of::<RtcRayHits<16>>() == 1344);
const _: () = assert!(size_of::<RtcRays<8>>() == 384 && std::mem::offset_of!(RtcHits<8>, geometry) == 192);

/// Called when Embree takes or returns memory; `false` would refuse it.
pub(crate) type MemoryMonitor = unsafe extern "C" fn(user: *mut c_void, bytes: isize, after: bool) -> bool;

/// Functions of a library, by their names.
macro_rules! symbols {
    ($(#[$about:meta])* $name:ident { $($(#[$doc:meta])* $field:ident = $symbol:literal: $type:ty;)* }) => {
        $(#[$about])*
        #[derive(Debug, Clone, Copy)]
        pub(crate) struct $name {
            $($(#[$doc])* pub(crate) $field: $type,)*
        }

        impl $name {
            /// Looks all of them up.
            pub(crate) fn look_up(library: &libloading::Library) -> Result<Self, libloading::Error> {
                // SAFETY: the symbols have these types in all releases of the version; it is checked before any but the
                // device's functions are called. The library outlives the pointers, since it is never unloaded.
                unsafe { Ok(Self { $($field: *library.get::<$type>(concat!($symbol, "\0").as_bytes())?,)* }) }
            }
        }
    };
}
pub(crate) use symbols;

symbols! {
    /// Embree's functions, by their names without `rtc`.
    Functions {
        new_device = "rtcNewDevice": unsafe extern "C" fn(*const c_char) -> Handle;
        release_device = "rtcReleaseDevice": unsafe extern "C" fn(Handle);
        /// The last error of this thread, which it clears; 0 for none.
        device_error = "rtcGetDeviceError": unsafe extern "C" fn(Handle) -> c_int;
        device_property = "rtcGetDeviceProperty": unsafe extern "C" fn(Handle, c_int) -> isize;
        set_memory_monitor = "rtcSetDeviceMemoryMonitorFunction": unsafe extern "C" fn(Handle, MemoryMonitor, *mut c_void);
        new_scene = "rtcNewScene": unsafe extern "C" fn(Handle) -> Handle;
        release_scene = "rtcReleaseScene": unsafe extern "C" fn(Handle);
        set_scene_flags = "rtcSetSceneFlags": unsafe extern "C" fn(Handle, c_int);
        set_scene_quality = "rtcSetSceneBuildQuality": unsafe extern "C" fn(Handle, c_int);
        commit_scene = "rtcCommitScene": unsafe extern "C" fn(Handle);
        new_geometry = "rtcNewGeometry": unsafe extern "C" fn(Handle, c_int) -> Handle;
        release_geometry = "rtcReleaseGeometry": unsafe extern "C" fn(Handle);
        /// Geometry, buffer type, slot, format, stride in bytes, items; gives the memory to fill.
        new_buffer = "rtcSetNewGeometryBuffer":
            unsafe extern "C" fn(Handle, c_int, c_uint, c_int, usize, usize) -> *mut c_void;
        set_geometry_quality = "rtcSetGeometryBuildQuality": unsafe extern "C" fn(Handle, c_int);
        commit_geometry = "rtcCommitGeometry": unsafe extern "C" fn(Handle);
        attach_geometry = "rtcAttachGeometry": unsafe extern "C" fn(Handle, Handle) -> c_uint;
    }
}
