//! A mesh in Embree, and rays cast through it.

use std::ffi::{CString, c_int, c_void};
use std::hint::black_box;
use std::ptr::null_mut;
use std::sync::atomic::{AtomicIsize, Ordering::Relaxed};

use anyhow::{Result, bail};

use crate::api::{self, Functions, Handle, INVALID_ID, Query, RtcHit, RtcRay, RtcRayHit};
use crate::clock::{process_nanos, thread_nanos};
use crate::files::Mesh;
use crate::library::Embree;
use crate::options::{Options, Quality};

/// A scene that holds one mesh. Single-threaded.
#[derive(Debug)]
pub(crate) struct Scene<'e> {
    rtc: &'e Functions,
    device: Handle,
    scene: Handle,
    build_nanos: u64,
}

/// What came of casting rays once.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Cast {
    /// CPU time of this thread, the set-up of each ray included.
    pub(crate) nanos: u64,
    /// Rays that hit something.
    pub(crate) hits: u64,
    /// Sum of the hit distances; 0 for occlusion.
    pub(crate) t_sum: f64,
}

/// What Embree holds at the moment, in bytes. There is one device only.
static BYTES: AtomicIsize = AtomicIsize::new(0);

unsafe extern "C" fn note_memory(_user: *mut c_void, bytes: isize, _after: bool) -> bool {
    BYTES.fetch_add(bytes, Relaxed);
    true
}

impl<'e> Scene<'e> {
    /// Builds the structure, on one thread.
    pub(crate) fn build(embree: &'e Embree, mesh: &Mesh, options: &Options) -> Result<Self> {
        let rtc = &embree.functions;
        let isa = options.isa.as_ref().map(|isa| format!(",isa={isa}")).unwrap_or_default();
        let config = CString::new(format!("threads=1{isa}"))?;
        // SAFETY: the configuration is a text that ends with a zero and lives until the call returns.
        let device = unsafe { (rtc.new_device)(config.as_ptr()) };
        if device.is_null() {
            // SAFETY: without a device, the call tells why none could be made.
            bail!("Embree makes no device with '{}': error {}", config.to_string_lossy(), unsafe {
                (rtc.device_error)(null_mut())
            });
        }
        let mut built = Self { rtc, device, scene: null_mut(), build_nanos: 0 };
        built.check_version()?;
        // SAFETY: the device is valid; the monitor is a function without captured state, and needs no user pointer.
        unsafe { (rtc.set_memory_monitor)(device, note_memory, null_mut()) };
        built.fill(mesh, options);
        built.check_error()?;
        Ok(built)
    }

    fn check_version(&self) -> Result<()> {
        match self.version_number() / 10_000 {
            4 => Ok(()),
            major => bail!("this program knows Embree 4, but the library is version {major}"),
        }
    }

    fn fill(&mut self, mesh: &Mesh, options: &Options) {
        let rtc = self.rtc;
        let quality = match options.quality {
            Quality::Medium => api::BUILD_QUALITY_MEDIUM,
            Quality::High => api::BUILD_QUALITY_HIGH,
        };
        // SAFETY: all handles come from this device and are used before they are released; the buffers that Embree gives
        // hold the items that were asked for, which `fill_buffer` relies on.
        unsafe {
            self.scene = (rtc.new_scene)(self.device);
            (rtc.set_scene_flags)(self.scene, if options.robust { api::SCENE_FLAG_ROBUST } else { 0 });
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

    /// CPU time of the build, all threads.
    pub(crate) fn build_nanos(&self) -> u64 {
        self.build_nanos
    }

    /// What Embree holds: its structure, and its copy of the mesh.
    pub(crate) fn bytes(&self) -> isize {
        BYTES.load(Relaxed)
    }

    /// `4.4.0`.
    pub(crate) fn version(&self) -> String {
        let version = self.version_number();
        format!("{}.{}.{}", version / 10_000, version / 100 % 100, version % 100)
    }

    fn version_number(&self) -> isize {
        // SAFETY: the device is valid.
        unsafe { (self.rtc.device_property)(self.device, api::DEVICE_PROPERTY_VERSION) }
    }

    /// Casts rays one by one, as a user would.
    pub(crate) fn cast(&self, rays: &[[f32; 8]], query: Query) -> Cast {
        let start = thread_nanos();
        let (hits, t_sum) = match query {
            Query::Closest => self.closest(rays),
            Query::Occluded => (self.occluded(rays), 0.0),
        };
        let (hits, t_sum) = black_box((hits, t_sum));
        Cast { nanos: thread_nanos() - start, hits, t_sum }
    }

    fn closest(&self, rays: &[[f32; 8]]) -> (u64, f64) {
        let (mut hits, mut t_sum) = (0, 0.0);
        for ray in rays {
            let mut query = RtcRayHit { ray: rtc_ray(ray), hit: NO_HIT };
            // SAFETY: the scene is committed, the structure has the layout and alignment that Embree 4 documents, and
            // null stands for the default arguments.
            unsafe { (self.rtc.intersect1)(self.scene, &raw mut query, null_mut()) };
            if query.hit.geometry != INVALID_ID {
                hits += 1;
                t_sum += f64::from(query.ray.t_far);
            }
        }
        (hits, t_sum)
    }

    fn occluded(&self, rays: &[[f32; 8]]) -> u64 {
        let mut hits = 0;
        for ray in rays {
            let mut query = rtc_ray(ray);
            // SAFETY: as for `intersect1`.
            unsafe { (self.rtc.occluded1)(self.scene, &raw mut query, null_mut()) };
            hits += u64::from(query.t_far == f32::NEG_INFINITY);
        }
        hits
    }
}

impl Drop for Scene<'_> {
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
fn rtc_ray(r: &[f32; 8]) -> RtcRay {
    RtcRay {
        origin: [r[0], r[1], r[2]],
        t_near: r[6],
        direction: [r[3], r[4], r[5]],
        time: 0.0,
        t_far: r[7],
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
