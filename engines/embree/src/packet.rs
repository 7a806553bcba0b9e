//! Eight or sixteen rays at a time, said to be coherent. Turning rays into packets is part of the work that is timed.

use std::ffi::c_uint;

use rdh_engine_protocol::{Query, Ray};

use crate::abi::{Abi, Valid};
use crate::api::{Handle, INVALID_ID, RtcHits, RtcRayHits, RtcRays};

/// Nothing hit yet.
const fn no_hit<const N: usize>() -> RtcHits<N> {
    RtcHits {
        normal: [[0.0; N]; 3],
        u: [0.0; N],
        v: [0.0; N],
        primitive: [INVALID_ID; N],
        geometry: [INVALID_ID; N],
        instance: [[INVALID_ID; N]],
        instance_primitive: [[INVALID_ID; N]],
    }
}

/// Casts rays, and shows each one's answer in turn: a distance, or 0 for an occlusion; infinite for a miss.
///
/// # Safety
/// The scene must be committed.
pub(crate) unsafe fn cast<const N: usize, A: Abi>(
    calls: &A,
    scene: Handle,
    rays: &[Ray],
    query: Query,
    mut see: impl FnMut(f32),
) {
    for rays in rays.chunks(N) {
        let valid = Valid(std::array::from_fn(|lane| if lane < rays.len() { -1 } else { 0 }));
        let mut packet = RtcRayHits::<N> { ray: transposed(rays), hit: no_hit() };
        match query {
            Query::Closest => {
                // SAFETY: the scene is committed, as the caller promises; the packet has the documented layout.
                unsafe { calls.intersect(&valid, scene, &mut packet) };
                for (geometry, t) in packet.hit.geometry.iter().zip(packet.ray.t_far).take(rays.len()) {
                    see(if *geometry == INVALID_ID { f32::INFINITY } else { t });
                }
            }
            Query::Occluded => {
                // SAFETY: as above.
                unsafe { calls.occluded(&valid, scene, &mut packet.ray) };
                for t in packet.ray.t_far.iter().take(rays.len()) {
                    see(if *t == f32::NEG_INFINITY { 0.0 } else { f32::INFINITY });
                }
            }
        }
    }
}

/// The rays, each in its lane; lanes without one hold copies of the last.
#[inline(always)]
fn transposed<const N: usize>(rays: &[Ray]) -> RtcRays<N> {
    let ray = |lane: usize| &rays[lane.min(rays.len() - 1)];
    RtcRays {
        origin: std::array::from_fn(|axis| std::array::from_fn(|lane| ray(lane).origin[axis])),
        t_near: std::array::from_fn(|lane| ray(lane).t_min),
        direction: std::array::from_fn(|axis| std::array::from_fn(|lane| ray(lane).direction[axis])),
        time: [0.0; N],
        t_far: std::array::from_fn(|lane| ray(lane).t_max),
        mask: [c_uint::MAX; N],
        id: [0; N],
        flags: [0; N],
    }
}
