//! What an animation makes of the nodes at a moment.

use std::collections::BTreeMap;

use super::Document;
use super::accessor::Accessor;
use super::schema::{Channel, Interpolation, Path, Sampler, Shape};
use crate::error::{Error, Result};

/// What is changed of a node.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct Change {
    pub translation: Option<[f64; 3]>,
    /// x, y, z, w.
    pub rotation: Option<[f64; 4]>,
    pub scale: Option<[f64; 3]>,
}

/// The changes that an animation makes at a moment; before its start and after its end it stands still.
///
/// # Errors
/// Channels whose times or values don't exist, don't fit or aren't finite, by animation and channel.
pub(super) fn sample(document: &Document, animation: usize, secs: f64) -> Result<BTreeMap<u32, Change>> {
    let mut changes: BTreeMap<u32, Change> = BTreeMap::new();
    let Some(about) = document.root.animations.get(animation) else { return Ok(changes) };
    for (number, channel) in about.channels.iter().enumerate() {
        let place = || format!("animation {animation}, channel {number}");
        let Some(node) = channel.target.node else { continue };
        let sampler = about.samplers.get(channel.sampler as usize);
        let sampler =
            sampler.ok_or_else(|| Error::at(place(), format!("sampler {} does not exist", channel.sampler)))?;
        let change = changes.entry(node).or_default();
        apply(document, channel, sampler, secs, change).map_err(|e| e.within(place()))?;
    }
    Ok(changes)
}

fn apply(document: &Document, channel: &Channel, sampler: &Sampler, secs: f64, change: &mut Change) -> Result<()> {
    match channel.target.path {
        Path::Translation => change.translation = Some(Curve::open(document, sampler, Shape::Vec3)?.at(secs, mix)?),
        Path::Scale => change.scale = Some(Curve::open(document, sampler, Shape::Vec3)?.at(secs, mix)?),
        Path::Rotation => change.rotation = Some(Curve::open(document, sampler, Shape::Vec4)?.at(secs, turn)?),
        Path::Other => {}
    }
    Ok(())
}

/// Values over time.
struct Curve<'a> {
    interpolation: Interpolation,
    times: Accessor<'a>,
    /// One a time; with cubic splines three: the tangent in, the value, the tangent out.
    values: Accessor<'a>,
}

impl<'a> Curve<'a> {
    fn open(document: &'a Document, sampler: &Sampler, shape: Shape) -> Result<Self> {
        let interpolation = sampler.interpolation;
        let (times, values) = (document.accessor(sampler.input)?, document.accessor(sampler.output)?);
        let of = |index: u32, reason: &str| Err(Error::at(format!("accessor {index}"), reason));
        if times.shape != Shape::Scalar || times.count == 0 {
            return of(sampler.input, "must be a list of times, and not be empty");
        }
        if values.shape != shape {
            return of(sampler.output, &format!("its elements must be of type {shape:?}"));
        }
        let each = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        if times.count.checked_mul(each).is_none_or(|needed| needed > values.count) {
            return of(sampler.output, "has too few values for the times");
        }
        Ok(Self { interpolation, times, values })
    }

    fn time(&self, key: usize) -> f64 {
        self.times.get::<1>(key)[0]
    }

    /// The value at a moment; `between` does linear interpolation.
    fn at<const N: usize>(&self, secs: f64, between: fn([f64; N], [f64; N], f64) -> [f64; N]) -> Result<[f64; N]> {
        let value = self.unchecked(secs, between);
        if value.iter().all(|x| x.is_finite()) {
            Ok(value)
        } else {
            Err(Error::whole(format!("its value at {secs} s is not finite")))
        }
    }

    fn unchecked<const N: usize>(&self, secs: f64, between: fn([f64; N], [f64; N], f64) -> [f64; N]) -> [f64; N] {
        let next = self.keys_until(secs);
        let last = self.times.count - 1;
        if next == 0 || next > last {
            return self.value(next.min(last));
        }
        let (key, span) = (next - 1, self.time(next) - self.time(next - 1));
        let part = (secs - self.time(key)) / span;
        match self.interpolation {
            Interpolation::Step => self.value(key),
            Interpolation::Linear => between(self.value(key), self.value(next), part),
            Interpolation::CubicSpline => self.cubic(key, part, span),
        }
    }

    /// How many keys are not later than a moment: by bisection, the times rise.
    fn keys_until(&self, secs: f64) -> usize {
        let (mut low, mut high) = (0, self.times.count);
        while low < high {
            let middle = low.midpoint(high);
            if self.time(middle) <= secs { low = middle + 1 } else { high = middle }
        }
        low
    }

    fn value<const N: usize>(&self, key: usize) -> [f64; N] {
        self.values.get(if self.interpolation == Interpolation::CubicSpline { 3 * key + 1 } else { key })
    }

    /// The cubic Hermite spline from a key to the next, as in appendix C of the glTF 2.0 specification.
    fn cubic<const N: usize>(&self, key: usize, t: f64, span: f64) -> [f64; N] {
        let (from, to): ([f64; N], [f64; N]) = (self.value(key), self.value(key + 1));
        let (out, into): ([f64; N], [f64; N]) = (self.values.get(3 * key + 2), self.values.get(3 * key + 3));
        let (t2, t3) = (t * t, t * t * t);
        std::array::from_fn(|i| {
            (2.0 * t3 - 3.0 * t2 + 1.0) * from[i]
                + span * (t3 - 2.0 * t2 + t) * out[i]
                + (3.0 * t2 - 2.0 * t3) * to[i]
                + span * (t3 - t2) * into[i]
        })
    }
}

fn mix<const N: usize>(a: [f64; N], b: [f64; N], t: f64) -> [f64; N] {
    std::array::from_fn(|i| a[i] + (b[i] - a[i]) * t)
}

/// Turns from one rotation to another, evenly and the shorter way round. Its length doesn't matter.
fn turn(a: [f64; 4], b: [f64; 4], t: f64) -> [f64; 4] {
    let dot: f64 = (0..4).map(|i| a[i] * b[i]).sum();
    let b = if dot < 0.0 { b.map(|x| -x) } else { b };
    let angle = dot.abs().min(1.0).acos();
    let sine = angle.sin();
    // So near that the weights would be 0 / 0; a straight line is as good.
    if sine < 1e-6 {
        return mix(a, b, t);
    }
    let (from, to) = (((1.0 - t) * angle).sin() / sine, (t * angle).sin() / sine);
    std::array::from_fn(|i| from * a[i] + to * b[i])
}
