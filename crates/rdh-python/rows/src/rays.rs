//! Rays out of arrays.

use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

use rdh::Ray;

use crate::Numbers;

/// Rays as rows of numbers, in world coordinates.
pub struct RayRows<'a> {
    form: Form<'a>,
    count: usize,
    /// What the scene's `[0, 0, 0]` is in world coordinates; it is subtracted before anything is rounded.
    origin: [f64; 3],
    /// The interval of rows that state none.
    interval: [f32; 2],
    /// The first ray that 32-bit floats can't hold.
    too_far: AtomicUsize,
}

enum Form<'a> {
    /// `ox oy oz dx dy dz`, and `t_min t_max` if there are eight columns.
    Rows { numbers: Numbers<'a>, columns: usize },
    /// Origins and directions apart; directions are given the length 1.
    Pairs { origins: Numbers<'a>, directions: Numbers<'a> },
}

impl<'a> RayRows<'a> {
    /// Over rows of six or eight columns.
    pub fn rows(numbers: Numbers<'a>, columns: usize, origin: [f64; 3]) -> Self {
        Self::new(Form::Rows { numbers, columns }, numbers.count() / columns, origin)
    }

    /// Over as many origins as directions.
    pub fn pairs(origins: Numbers<'a>, directions: Numbers<'a>, origin: [f64; 3]) -> Self {
        Self::new(Form::Pairs { origins, directions }, origins.count() / 3, origin)
    }

    fn new(form: Form<'a>, count: usize, origin: [f64; 3]) -> Self {
        let interval = [0.0, f32::INFINITY];
        Self { form, count, origin, interval, too_far: AtomicUsize::new(usize::MAX) }
    }

    /// The same, but rows without an interval have this one.
    pub fn within(self, t_min: f32, t_max: f32) -> Self {
        Self { interval: [t_min, t_max], ..self }
    }

    /// How many rays there are.
    pub fn count(&self) -> usize {
        self.count
    }

    /// A ray in the scene's coordinates.
    pub fn get(&self, index: usize) -> Ray {
        match &self.form {
            Form::Rows { numbers: Numbers::F32(all), columns } if self.origin == [0.0; 3] => {
                let row = &all[index * columns..][..*columns];
                let [t_min, t_max] = if let [.., t_min, t_max] = *row
                    && *columns == 8
                {
                    [t_min, t_max]
                } else {
                    self.interval
                };
                Ray::from([row[0], row[1], row[2], row[3], row[4], row[5], t_min, t_max])
            }
            Form::Rows { numbers, columns } => {
                let at = index * columns;
                let [t_min, t_max] = match numbers {
                    Numbers::F32(all) if *columns == 8 => [all[at + 6], all[at + 7]],
                    Numbers::F64(all) if *columns == 8 => [all[at + 6] as f32, all[at + 7] as f32],
                    _ => self.interval,
                };
                self.rounded(index, numbers.triple(at), numbers.triple(at + 3)).within(t_min, t_max)
            }
            Form::Pairs { origins, directions } => {
                let direction = unit(directions.triple(3 * index));
                self.rounded(index, origins.triple(3 * index), direction).within(self.interval[0], self.interval[1])
            }
        }
    }

    /// Rays that follow each other, in place of what `rays` holds.
    pub fn read(&self, first: usize, count: usize, rays: &mut Vec<Ray>) {
        rays.clear();
        rays.extend((first..).take(count).map(|index| self.get(index)));
    }

    /// A ray's origin and direction in world coordinates, as they were given.
    pub fn exact(&self, index: usize) -> ([f64; 3], [f64; 3]) {
        match &self.form {
            Form::Rows { numbers, columns } => (numbers.triple(index * columns), numbers.triple(index * columns + 3)),
            Form::Pairs { origins, directions } => (origins.triple(3 * index), directions.triple(3 * index)),
        }
    }

    /// The first ray that did not fit in 32-bit floats; to be asked when all have been got.
    pub fn too_far(&self) -> Option<usize> {
        Some(self.too_far.load(Relaxed)).filter(|&ray| ray != usize::MAX)
    }

    #[inline]
    fn rounded(&self, index: usize, origin: [f64; 3], direction: [f64; 3]) -> Ray {
        let relative = [0, 1, 2].map(|a| origin[a] - self.origin[a]);
        let ray = Ray::new(relative.map(|x| x as f32), direction.map(|x| x as f32));
        if !ray.is_valid() && is_sound(relative, direction) {
            self.too_far.fetch_min(index, Relaxed);
        }
        ray
    }
}

/// Whether a ray can hit something as long as it is not rounded.
#[cold]
fn is_sound(origin: [f64; 3], direction: [f64; 3]) -> bool {
    origin.iter().chain(&direction).all(|x| x.is_finite()) && direction != [0.0; 3]
}

/// The direction with the length 1; zero and what is not finite stay what they are.
#[inline]
fn unit(direction: [f64; 3]) -> [f64; 3] {
    let square = direction.iter().map(|x| x * x).sum::<f64>();
    if (1e-200..1e200).contains(&square) {
        let scale = 1.0 / square.sqrt();
        return direction.map(|x| x * scale);
    }
    unit_of_any_size(direction)
}

/// Scaled first, so that no square is too small or too large.
#[cold]
fn unit_of_any_size(direction: [f64; 3]) -> [f64; 3] {
    let largest = direction.iter().fold(0.0, |most: f64, x| most.max(x.abs()));
    if !(largest > 0.0 && largest.is_finite()) {
        return direction;
    }
    let scaled = direction.map(|x| x / largest);
    let length = scaled.iter().map(|x| x * x).sum::<f64>().sqrt();
    scaled.map(|x| x / length)
}
