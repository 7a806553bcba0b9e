//! Sixteen rays at a time, said to be coherent. Turning rays into packets is part of the work that is timed.

use std::ffi::c_uint;

use rdh_engine_protocol::{Query, Ray};

use crate::abi::{Abi, Valid};
use crate::api::{Handle, INVALID_ID, RtcHit16, RtcRay16, RtcRayHit16};

const NO_HIT: RtcHit16 = RtcHit16 {
    normal: [[0.0; 16]; 3],
    u: [0.0; 16],
    v: [0.0; 16],
    primitive: [INVALID_ID; 16],
    geometry: [INVALID_ID; 16],
    instance: [[INVALID_ID; 16]],
    instance_primitive: [[INVALID_ID; 16]],
};

/// Casts rays, and shows each one's answer in turn: a distance, or 0 for an occlusion; infinite for a miss.
///
/// # Safety
/// The scene must be committed.
pub(crate) unsafe fn cast<A: Abi>(calls: &A, scene: Handle, rays: &[Ray], query: Query, mut see: impl FnMut(f32)) {
    for rays in rays.chunks(16) {
        let valid = Valid(std::array::from_fn(|lane| if lane < rays.len() { -1 } else { 0 }));
        let mut packet = RtcRayHit16 { ray: transposed(rays), hit: NO_HIT };
        match query {
            Query::Closest => {
                // SAFETY: the scene is committed, as the caller promises; the packet has the documented layout.
                unsafe { calls.intersect16(&valid, scene, &mut packet) };
                for (geometry, t) in packet.hit.geometry.iter().zip(packet.ray.t_far).take(rays.len()) {
                    see(if *geometry == INVALID_ID { f32::INFINITY } else { t });
                }
            }
            Query::Occluded => {
                // SAFETY: as above.
                unsafe { calls.occluded16(&valid, scene, &mut packet.ray) };
                for t in packet.ray.t_far.iter().take(rays.len()) {
                    see(if *t == f32::NEG_INFINITY { 0.0 } else { f32::INFINITY });
                }
            }
        }
    }
}

/// The rays, each in its lane; lanes without one hold copies of the last.
#[inline(always)]
fn transposed(rays: &[Ray]) -> RtcRay16 {
    let ray = |lane: usize| &rays[lane.min(rays.len() - 1)];
    RtcRay16 {
        origin: std::array::from_fn(|axis| std::array::from_fn(|lane| ray(lane).origin[axis])),
        t_near: std::array::from_fn(|lane| ray(lane).t_min),
        direction: std::array::from_fn(|axis| std::array::from_fn(|lane| ray(lane).direction[axis])),
        time: [0.0; 16],
        t_far: std::array::from_fn(|lane| ray(lane).t_max),
        mask: [c_uint::MAX; 16],
        id: [0; 16],
        flags: [0; 16],
    }
}
