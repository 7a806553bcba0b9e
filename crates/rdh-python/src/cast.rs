//! Batches in Open3D's shapes.

use numpy::{Element, PyArrayMethods, PyReadwriteArrayDyn};
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyString};
use rayon::ThreadPool;
use rdh::{Hit, Mesh, Ray};
use rdh_rows::{RayRows, unit_normal};

use crate::arrays::{refuse, zeros};
use crate::batch::{self, Columns, Window};
use crate::world::{Caster, World};

/// The id of a miss, as in Embree and Open3D.
pub(crate) const INVALID_ID: u32 = u32::MAX;

/// What `cast_rays` can say of a ray.
const FIELDS: [&str; 5] = ["t_hit", "geometry_ids", "primitive_ids", "primitive_uvs", "primitive_normals"];

/// Which of [`FIELDS`] are wanted.
pub(crate) struct Wanted([bool; FIELDS.len()]);

impl Wanted {
    /// Every one.
    pub(crate) const ALL: Self = Self([true; FIELDS.len()]);

    /// Reads names one by one: what is given may claim any length.
    ///
    /// # Errors
    /// `ValueError` for what is not a list of names, or an unknown one.
    pub(crate) fn read(fields: &Bound<'_, PyAny>) -> PyResult<Self> {
        let refused = |what: &Bound<'_, PyAny>| {
            let what = what.repr().map_or_else(|_| "this".to_owned(), |text| text.to_string());
            refuse("fields", format_args!("{what} is none of {}", FIELDS.join(", ")))
        };
        let mut wanted = [false; FIELDS.len()];
        for field in fields.try_iter().map_err(|_| refuse("fields", "a list of names is needed"))? {
            let field = field?;
            let name = field.cast::<PyString>().map_err(|_| refused(&field))?;
            let place = FIELDS.iter().position(|known| name == known).ok_or_else(|| refused(&field))?;
            wanted[place] = true;
        }
        Ok(Self(wanted))
    }
}

/// The arrays of those fields, each with a row a ray.
#[derive(Default)]
struct Fields<'a> {
    t_hit: Option<&'a mut [f32]>,
    geometry_ids: Option<&'a mut [u32]>,
    primitive_ids: Option<&'a mut [u32]>,
    primitive_uvs: Option<&'a mut [f32]>,
    primitive_normals: Option<&'a mut [f32]>,
}

impl Columns for Fields<'_> {
    fn take(&mut self, rows: usize) -> Self {
        Self {
            t_hit: part(&mut self.t_hit, rows),
            geometry_ids: part(&mut self.geometry_ids, rows),
            primitive_ids: part(&mut self.primitive_ids, rows),
            primitive_uvs: part(&mut self.primitive_uvs, 2 * rows),
            primitive_normals: part(&mut self.primitive_normals, 3 * rows),
        }
    }
}

fn part<'a, T: Send>(column: &mut Option<&'a mut [T]>, entries: usize) -> Option<&'a mut [T]> {
    column.as_mut().map(|column| column.take(entries))
}

impl Fields<'_> {
    fn set(&mut self, row: usize, hit: Option<Hit>, mesh: &Mesh) {
        if let Some(t_hit) = &mut self.t_hit {
            t_hit[row] = hit.map_or(f32::INFINITY, |h| h.t);
        }
        if let Some(ids) = &mut self.geometry_ids {
            ids[row] = hit.map_or(INVALID_ID, |h| h.geometry.0);
        }
        if let Some(ids) = &mut self.primitive_ids {
            ids[row] = hit.map_or(INVALID_ID, |h| h.tri.0);
        }
        // What there is no hit for stays zero.
        let Some(hit) = hit else { return };
        if let Some(uvs) = &mut self.primitive_uvs {
            uvs[2 * row..2 * row + 2].copy_from_slice(&[hit.u, hit.v]);
        }
        if let Some(normals) = &mut self.primitive_normals {
            normals[3 * row..3 * row + 3].copy_from_slice(&unit_normal(mesh.corners(hit.tri)));
        }
    }
}

/// Casts rays for their nearest hits; the arrays of `wanted` fields, in the shape of the rays.
///
/// # Errors
/// `ValueError` for rays out of range, `MemoryError`, or what a signal's handler raises.
pub(crate) fn closest<'py>(
    py: Python<'py>,
    pool: &ThreadPool,
    world: &World,
    rays: &RayRows<'_>,
    shape: &[usize],
    wanted: Wanted,
) -> PyResult<Bound<'py, PyDict>> {
    let made = Made { result: PyDict::new(py), shape, wanted };
    let mut t_hit = made.column::<f32>(0, None)?;
    let mut geometry_ids = made.column::<u32>(1, None)?;
    let mut primitive_ids = made.column::<u32>(2, None)?;
    let mut primitive_uvs = made.column::<f32>(3, Some(2))?;
    let mut primitive_normals = made.column::<f32>(4, Some(3))?;
    let fields = Fields {
        t_hit: rows(&mut t_hit)?,
        geometry_ids: rows(&mut geometry_ids)?,
        primitive_ids: rows(&mut primitive_ids)?,
        primitive_uvs: rows(&mut primitive_uvs)?,
        primitive_normals: rows(&mut primitive_normals)?,
    };
    let caster = world.caster();
    batch::fill(py, pool, rays.count(), fields, |window, mut fields| {
        let (mut batch, mut hits) = (Vec::new(), Vec::new());
        // First all are traced, then their results fetched: so the processor waits for many of the mesh's triangles at a time.
        window.batches(|rows, first| {
            rays.read(first, rows.len(), &mut batch);
            caster.closest_many(&batch, &mut hits);
            rows.zip(&hits).for_each(|(row, hit)| fields.set(row, *hit, caster.accel.mesh()));
        });
    })?;
    check(rays, "rays")?;
    Ok(made.result)
}

/// Refuses rays that did not fit in 32-bit floats; to be asked when all have been got.
///
/// # Errors
/// `ValueError` naming the argument and the first such ray.
pub(crate) fn check(rays: &RayRows<'_>, argument: &str) -> PyResult<()> {
    match rays.too_far() {
        None => Ok(()),
        Some(ray) => Err(refuse(argument, format_args!("ray {ray} is beyond the range of 32-bit floats"))),
    }
}

/// The dictionary of results, as it is filled with arrays.
struct Made<'a, 'py> {
    result: Bound<'py, PyDict>,
    shape: &'a [usize],
    wanted: Wanted,
}

/// An array of results while its numbers are written.
type Held<'py, T> = Option<PyReadwriteArrayDyn<'py, T>>;

impl<'py> Made<'_, 'py> {
    /// An array in the shape of the rays, with an axis for `more` numbers a ray; nothing if the field is not wanted.
    fn column<T: Element>(&self, field: usize, more: Option<usize>) -> PyResult<Held<'py, T>> {
        if !self.wanted.0[field] {
            return Ok(None);
        }
        let shape: Vec<_> = self.shape.iter().copied().chain(more).collect();
        let array = zeros::<T>(self.result.py(), &shape)?;
        self.result.set_item(FIELDS[field], &array)?;
        Ok(Some(array.try_readwrite()?))
    }
}

fn rows<'a, T: Element>(held: &'a mut Held<'_, T>) -> PyResult<Option<&'a mut [T]>> {
    Ok(held.as_mut().map(|array| array.as_slice_mut()).transpose()?)
}

/// One number a ray, in the shape of the rays; `answer` gets many rays at a time, and where their numbers go.
///
/// # Errors
/// As [`closest`].
pub(crate) fn many<'py, T: Element>(
    py: Python<'py>,
    pool: &ThreadPool,
    world: &World,
    rays: &RayRows<'_>,
    shape: &[usize],
    argument: &str,
    answer: impl Fn(&Caster, &[Ray], &mut [T]) + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    numbers(py, pool, rays, shape, argument, world.caster(), |window, caster, numbers| {
        let mut batch = Vec::new();
        window.batches(|rows, first| {
            rays.read(first, rows.len(), &mut batch);
            answer(caster, &batch, &mut numbers[rows]);
        });
    })
}

/// The same, ray by ray.
///
/// # Errors
/// As [`closest`].
pub(crate) fn each<'py, T: Element>(
    py: Python<'py>,
    pool: &ThreadPool,
    world: &World,
    rays: &RayRows<'_>,
    shape: &[usize],
    argument: &str,
    answer: impl Fn(&Caster, &Ray, &mut Vec<Hit>) -> T + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    numbers(py, pool, rays, shape, argument, world.caster(), |window, caster, numbers| {
        let mut hits = Vec::new();
        window.each(|row, ray| numbers[row] = answer(caster, &rays.get(ray), &mut hits));
    })
}

fn numbers<'py, T: Element>(
    py: Python<'py>,
    pool: &ThreadPool,
    rays: &RayRows<'_>,
    shape: &[usize],
    argument: &str,
    caster: Caster,
    work: impl Fn(&Window<'_>, &Caster, &mut [T]) + Sync,
) -> PyResult<Bound<'py, PyAny>> {
    let array = zeros::<T>(py, shape)?;
    let mut held = array.try_readwrite()?;
    batch::fill(py, pool, rays.count(), held.as_slice_mut()?, |window, numbers| work(window, &caster, numbers))?;
    check(rays, argument)?;
    Ok(array.into_any())
}

/// What is found for the rays of a window: several things a ray, ray by ray.
pub(crate) struct Found<T> {
    /// How many each ray has.
    pub(crate) counts: Vec<u32>,
    /// All of them.
    pub(crate) things: Vec<T>,
}

impl<T> Found<T> {
    /// Nothing yet, for so many rays.
    pub(crate) fn with_capacity(rays: usize) -> Self {
        Self { counts: Vec::with_capacity(rays), things: Vec::new() }
    }

    /// How many things there are.
    pub(crate) fn len(&self) -> usize {
        self.things.len()
    }

    /// The things of each ray.
    pub(crate) fn rows(&self) -> impl Iterator<Item = &[T]> {
        let mut rest = &self.things[..];
        self.counts.iter().map(move |&count| {
            let (of_ray, others) = rest.split_at(count as usize);
            rest = others;
            of_ray
        })
    }
}

/// All hits of all rays, as one list with the places at which it is split.
///
/// # Errors
/// As [`closest`].
pub(crate) fn list<'py>(
    py: Python<'py>,
    pool: &ThreadPool,
    world: &World,
    rays: &RayRows<'_>,
) -> PyResult<Bound<'py, PyDict>> {
    let caster = world.caster();
    let parts = batch::map(py, pool, rays.count(), |window| {
        let (mut found, mut of_one) = (Found::with_capacity(window.len()), Vec::new());
        window.each(|_, ray| {
            caster.all_hits(&rays.get(ray), &mut of_one);
            found.counts.push(of_one.len() as u32);
            found.things.extend_from_slice(&of_one);
        });
        found
    })?;
    check(rays, "rays")?;
    let rows = || parts.iter().flat_map(Found::rows);
    let hits = || rows().flatten();
    let count = parts.iter().map(Found::len).sum();
    let mut end = 0;
    let splits = rows().map(|hits| {
        end += hits.len() as i64;
        end
    });
    let ray_ids = rows().enumerate().flat_map(|(ray, hits)| std::iter::repeat_n(ray as i64, hits.len()));
    let result = PyDict::new(py);
    result.set_item("ray_splits", filled(py, &[rays.count() + 1], std::iter::once(0).chain(splits))?)?;
    result.set_item("ray_ids", filled(py, &[count], ray_ids)?)?;
    result.set_item(FIELDS[0], filled(py, &[count], hits().map(|h| h.t))?)?;
    result.set_item(FIELDS[1], filled(py, &[count], hits().map(|h| h.geometry.0))?)?;
    result.set_item(FIELDS[2], filled(py, &[count], hits().map(|h| h.tri.0))?)?;
    result.set_item(FIELDS[3], filled(py, &[count, 2], hits().flat_map(|h| [h.u, h.v]))?)?;
    Ok(result)
}

/// A new array with these numbers.
fn filled<'py, T: Element>(
    py: Python<'py>,
    shape: &[usize],
    numbers: impl Iterator<Item = T>,
) -> PyResult<Bound<'py, PyAny>> {
    let array = zeros::<T>(py, shape)?;
    for (place, number) in array.try_readwrite()?.as_slice_mut()?.iter_mut().zip(numbers) {
        *place = number;
    }
    Ok(array.into_any())
}
