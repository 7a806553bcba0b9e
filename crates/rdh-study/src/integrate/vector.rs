//! Three-vectors in f64: rays are made in double precision and rounded once.

pub(crate) type V3 = [f64; 3];

pub(crate) fn wide(a: [f32; 3]) -> V3 {
    a.map(f64::from)
}

pub(crate) fn narrow(a: V3) -> [f32; 3] {
    a.map(|x| x as f32)
}

pub(crate) fn add(a: V3, b: V3) -> V3 {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

pub(crate) fn sub(a: V3, b: V3) -> V3 {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

pub(crate) fn scale(a: V3, by: f64) -> V3 {
    a.map(|x| x * by)
}

pub(crate) fn dot(a: V3, b: V3) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

pub(crate) fn cross(a: V3, b: V3) -> V3 {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

pub(crate) fn length(a: V3) -> f64 {
    dot(a, a).sqrt()
}

/// The vector of length 1 along `a`; nothing for a vector without a direction.
pub(crate) fn unit(a: V3) -> Option<V3> {
    let length = length(a);
    (length > 0.0 && length.is_finite()).then(|| a.map(|x| x / length))
}

/// The largest absolute component.
pub(crate) fn magnitude(a: V3) -> f64 {
    a.iter().fold(0.0, |m, x| x.abs().max(m))
}
