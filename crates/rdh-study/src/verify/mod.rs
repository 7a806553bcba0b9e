//! Whether a finished structure gives the answers of brute force.

mod aim;

use rayon::prelude::*;
use rdh::{Accel, Hit, Mesh, Ray, naive};
use serde::Serialize;

pub use aim::aimed_rays;

/// How the answers of a structure compare with brute force.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Agreement {
    /// Rays that were cast.
    pub rays: usize,
    /// Rays with another answer.
    pub different: usize,
    /// The first of them, in words.
    pub first: Option<String>,
}

/// Casts rays through a structure and against all triangles: closest hit, any hit and all hits, bit for bit. O(rays · triangles), on all
/// threads of rayon's current pool.
pub fn agreement(accel: &Accel, mesh: &Mesh, rays: &[Ray]) -> Agreement {
    let wrong: Vec<Option<String>> = rays.par_iter().map(|ray| difference(accel, mesh, ray)).collect();
    let different = wrong.iter().flatten().count();
    Agreement { rays: rays.len(), different, first: wrong.into_iter().flatten().next() }
}

/// How the answers to a ray differ, if they do.
fn difference(accel: &Accel, mesh: &Mesh, ray: &Ray) -> Option<String> {
    let (found, expected) = (accel.closest(ray), naive::closest(mesh, ray));
    let wrong = |what: String| Some(format!("{what} ({ray:?})"));
    if found.as_ref().map(bits) != expected.as_ref().map(bits) {
        return wrong(format!("the nearest hit is {}, not {}", words(expected), words(found)));
    }
    if accel.occluded(ray) != expected.is_some() {
        return wrong(format!("the nearest hit is {}, but any hit says {}", words(expected), accel.occluded(ray)));
    }
    let (mut all, expected) = (Vec::new(), naive::all_hits(mesh, ray));
    accel.all_hits(ray, &mut all);
    if all.iter().map(bits).ne(expected.iter().map(bits)) {
        return wrong(format!("there are {} hits, not {}, or others", expected.len(), all.len()));
    }
    None
}

fn bits(hit: &Hit) -> [u32; 4] {
    [hit.t.to_bits(), hit.u.to_bits(), hit.v.to_bits(), hit.tri.0]
}

fn words(hit: Option<Hit>) -> String {
    hit.map_or_else(|| "none".to_owned(), |hit| format!("triangle {} at t = {}", hit.tri.0, hit.t))
}
