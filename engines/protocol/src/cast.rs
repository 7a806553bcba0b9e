//! Casting a file of rays: timed, or keeping each ray's answer.

use std::hint::black_box;

use anyhow::Result;

use crate::clock::thread_nanos;
use crate::engine::{Engine, Query, Ray};

/// In what form rays are handed over.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// One by one.
    Single,
    /// Sixteen at a time, said to be coherent.
    Packets,
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

/// Casts rays as a user would, and takes the time.
pub(crate) fn timed(engine: &impl Engine, rays: &[Ray], query: Query, form: Form) -> Result<Cast> {
    let (mut hits, mut t_sum) = (0, 0.0);
    let start = thread_nanos();
    cast(engine, rays, query, form, |t| {
        if t < f32::INFINITY {
            hits += 1;
            t_sum += f64::from(t);
        }
    })?;
    let (hits, t_sum) = black_box((hits, t_sum));
    let nanos = thread_nanos() - start;
    Ok(Cast { nanos, hits, t_sum: if query == Query::Closest { t_sum } else { 0.0 } })
}

/// Each ray's distance, infinite for a miss; for an occlusion 0.
pub(crate) fn answers(engine: &impl Engine, rays: &[Ray], query: Query, form: Form) -> Result<Vec<f32>> {
    let mut answers = Vec::with_capacity(rays.len());
    cast(engine, rays, query, form, |t| {
        answers.push(if query == Query::Occluded && t < f32::INFINITY { 0.0 } else { t });
    })?;
    Ok(answers)
}

#[inline(always)]
fn cast(engine: &impl Engine, rays: &[Ray], query: Query, form: Form, mut see: impl FnMut(f32)) -> Result<()> {
    match (form, query) {
        (Form::Packets, _) => engine.packets(rays, query, see)?,
        (Form::Single, Query::Closest) => rays.iter().for_each(|ray| see(engine.closest(ray))),
        (Form::Single, Query::Occluded) => {
            rays.iter().for_each(|ray| see(if engine.occluded(ray) { 0.0 } else { f32::INFINITY }));
        }
    }
    Ok(())
}
