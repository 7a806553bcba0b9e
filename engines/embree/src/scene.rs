//! A mesh in Embree, and rays cast through it.

use std::ffi::{CString, c_int, c_void};
use std::ptr::null_mut;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};

use anyhow::{Result, bail};
use rdh_engine_protocol::clock::process_nanos;
use rdh_engine_protocol::{Built, Engine, Mesh, Query, Ray};

use crate::abi::Abi;
use crate::api::{self, Functions, Handle, INVALID_ID, RtcHit, RtcRay, RtcRayHit};
use crate::library;
use crate::mode::{Mode, Quality};
use crate::packet;

/// A scene that holds one mesh. Single-threaded.
#[derive(Debug)]
pub(crate) struct Scene<A> {
    rtc: Functions,
    calls: A,
    device: Handle,
    scene: Handle,
    build_nanos: u64,
}

impl<A: Abi> Engine for Scene<A> {
    const NAME: &'static str = A::NAME;

    fn build(mesh: Mesh, mode: &str) -> Result<Built<Self>> {
        let mode: Mode = mode.parse()?;
        mode.check()?;
        let (rtc, calls) = library::load::<A>()?;
        let engine = Self::commit(rtc, calls, &mesh, &mode)?;
        let (version, build_nanos, bytes) = (engine.version(), engine.build_nanos, BYTES.load(Relaxed));
        Ok(Built { engine, version, build_nanos, bytes: u64::try_from(bytes)? })
    }

    #[inline(always)]
    fn closest(&self, ray: &Ray) -> f32 {
        let mut query = RtcRayHit { ray: rtc_ray(ray), hit: NO_HIT };
        // SAFETY: the scene is committed, and the structure has the layout and alignment that Embree documents.
        unsafe { self.calls.intersect1(self.scene, &mut query) };
        if query.hit.geometry == INVALID_ID { f32::INFINITY } else { query.ray.t_far }
    }

    #[inline(always)]
    fn occluded(&self, ray: &Ray) -> bool {
        let mut query = rtc_ray(ray);
        // SAFETY: as for `intersect1`.
        unsafe { self.calls.occluded1(self.scene, &mut query) };
        query.t_far == f32::NEG_INFINITY
    }

    fn packets(&self, rays: &[Ray], query: Query, see: impl FnMut(f32)) -> Result<()> {
        // Sixteen where the instructions are that wide: elsewhere Embree would trace a packet of sixteen ray by ray.
        // SAFETY: the device is valid, and the scene is committed.
        unsafe {
            if (self.rtc.device_property)(self.device, api::DEVICE_PROPERTY_NATIVE_RAY16) != 0 {
                packet::cast::<16, A>(&self.calls, self.scene, rays, query, see);
            } else {
                packet::cast::<8, A>(&self.calls, self.scene, rays, query, see);
            }
        }
        Ok(())
    }
}

/// What Embree holds at the moment, in bytes. There is one device only.
static BYTES: AtomicIsize = AtomicIsize::new(0);

unsafe extern "C" fn note_memory(_user: *mut c_void, bytes: isize, _after: bool) -> bool {
    BYTES.fetch_add(bytes, Relaxed);
    true
}

impl<A: Abi> Scene<A> {
    /// Builds the structure, on one thread.
    fn commit(rtc: Functions, calls: A, mesh: &Mesh, mode: &Mode) -> Result<Self> {
        let config = CString::new(format!("threads=1,isa={}", mode.isa))?;
        // SAFETY: the configuration is a text that ends with a zero and lives until the call returns.
        let device = unsafe { (rtc.new_device)(config.as_ptr()) };
        if device.is_null() {
            // SAFETY: without a device, the call tells why none could be made.
            bail!("Embree makes no device with '{}': error {}", config.to_string_lossy(), unsafe {
                (rtc.device_error)(null_mut())
            });
        }
        let mut built = Self { rtc, calls, device, scene: null_mut(), build_nanos: 0 };
        built.check_version()?;
        // SAFETY: the device is valid; the monitor is a function without captured state, and needs no user pointer.
        unsafe { (rtc.set_memory_monitor)(device, note_memory, null_mut()) };
        built.fill(mesh, mode);
        built.check_error()?;
        Ok(built)
    }

    fn check_version(&self) -> Result<()> {
        match self.version_number() / 10_000 {
            major if major == A::MAJOR => Ok(()),
            major => bail!("this program knows Embree {}, but the library is version {major}", A::MAJOR),
        }
    }

    fn fill(&mut self, mesh: &Mesh, mode: &Mode) {
        let rtc = &self.rtc;
        let quality = match mode.quality {
            Quality::Medium => api::BUILD_QUALITY_MEDIUM,
            Quality::High => api::BUILD_QUALITY_HIGH,
        };
        // SAFETY: all handles come from this device and are used before they are released; the buffers that Embree gives
        // hold the items that were asked for, which `fill_buffer` relies on.
        unsafe {
            self.scene = (rtc.new_scene)(self.device);
            (rtc.set_scene_flags)(self.scene, if mode.robust { api::SCENE_FLAG_ROBUST } else { 0 });
            (rtc.set_scene_quality)(self.scene, quality);
            let geometry = (rtc.new_geometry)(self.device, api::GEOMETRY_TYPE_TRIANGLE);
            fill_buffer(rtc, geometry, api::BUFFER_TYPE_VERTEX, api::FORMAT_FLOAT3, &mesh.positions);
            fill_buffer(rtc, geometry, api::BUFFER_TYPE_INDEX, api::FORMAT_UINT3, &mesh.triangles);
            (rtc.set_geometry_quality)(geometry, quality);
            let start = process_nanos();
            (rtc.commit_geometry)(geometry);
            (rtc.attach_geometry)(self.scene, geometry);
            (rtc.release_geometry)(geometry);
            (rtc.commit_scene)(self.scene);
            self.build_nanos = process_nanos() - start;
        }
    }

    fn check_error(&self) -> Result<()> {
        // SAFETY: the device is valid.
        match unsafe { (self.rtc.device_error)(self.device) } {
            0 => Ok(()),
            code => bail!("Embree reports error {code} of RTCError"),
        }
    }

    /// `4.4.0`.
    fn version(&self) -> String {
        let version = self.version_number();
        format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    fn version_number(&self) -> isize {
        // SAFETY: the device is valid.
        unsafe { (self.rtc.device_property)(self.device, api::DEVICE_PROPERTY_VERSION) }
    }
}

impl<A> Drop for Scene<A> {
    fn drop(&mut self) {
        // SAFETY: both handles are owned by this value and not used afterwards; a scene may be missing.
        unsafe {
            if !self.scene.is_null() {
                (self.rtc.release_scene)(self.scene);
            }
            (self.rtc.release_device)(self.device);
        }
    }
}

const NO_HIT: RtcHit = RtcHit {
    normal: [0.0; 3],
    u: 0.0,
    v: 0.0,
    primitive: INVALID_ID,
    geometry: INVALID_ID,
    instance: [INVALID_ID],
    instance_primitive: [INVALID_ID],
};

#[inline(always)]
fn rtc_ray(ray: &Ray) -> RtcRay {
    RtcRay {
        origin: ray.origin,
        t_near: ray.t_min,
        direction: ray.direction,
        time: 0.0,
        t_far: ray.t_max,
        mask: u32::MAX,
        id: 0,
        flags: 0,
    }
}

/// Copies items into a new buffer of a geometry; if Embree has no memory for it, its error stands.
///
/// # Safety
/// `geometry` must be valid, and `format` that of `T`.
unsafe fn fill_buffer<T: Copy>(rtc: &Functions, geometry: Handle, kind: c_int, format: c_int, items: &[T]) {
    // SAFETY: the geometry is valid, as the caller promises. Embree gives a buffer of at least `len` items of
    // `size_of::<T>()` bytes, aligned to 16 bytes, or null; nobody else refers to it.
    unsafe {
        let buffer = (rtc.new_buffer)(geometry, kind, 0, format, size_of::<T>(), items.len()).cast::<T>();
        if !buffer.is_null() {
            buffer.copy_from_nonoverlapping(items.as_ptr(), items.len());
        }
    }
}
