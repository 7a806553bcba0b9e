//! What `rdh.trimesh` asks for: rays as origins and directions, answers in trimesh's types.

use numpy::{PyArray1, PyArray2, PyArrayMethods};
use pyo3::prelude::*;
use rayon::ThreadPool;
use rdh::{Hit, Ray};
use rdh_rows::{Meeting, Numbers, RayRows, place_meetings};

use crate::arrays::{Floats, refuse, zeros};
use crate::batch;
use crate::cast::{self, Found, check};
use crate::pool::pool;
use crate::scene::Scene;
use crate::world::{Caster, World};

/// Ids of the first triangles that rays hit, int32; -1 for a miss.
#[pyfunction]
pub(crate) fn _first<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    threads: Option<i64>,
) -> PyResult<Bound<'py, PyAny>> {
    Pairs::read(origins, directions)?.many(py, scene.world(), threads, |caster, rays, ids| {
        let mut hits = Vec::new();
        caster.closest_many(rays, &mut hits);
        ids.iter_mut().zip(&hits).for_each(|(id, hit)| *id = hit.map_or(-1, |hit| hit.tri.0 as i32));
    })
}

/// Whether rays hit anything, bool.
#[pyfunction]
pub(crate) fn _any<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    threads: Option<i64>,
) -> PyResult<Bound<'py, PyAny>> {
    Pairs::read(origins, directions)?.many(py, scene.world(), threads, |caster, rays, occluded| {
        caster.occluded_many(rays, occluded);
    })
}

/// How many triangles rays go through, int64.
#[pyfunction]
pub(crate) fn _count<'py>(
    py: Python<'py>,
    scene: &Scene,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    threads: Option<i64>,
) -> PyResult<Bound<'py, PyAny>> {
    Pairs::read(origins, directions)?.each(py, scene.world(), threads, |caster, ray, hits| {
        caster.all_hits(ray, hits);
        hits.len() as i64
    })
}

/// Triangles and rays that meet, `(m,)` int64 each, and where, `(m, 3)` float64 on the planes of `vertices`; ray after ray, nearest
/// first. `most` hits a ray: 1 asks for the nearest only.
#[pyfunction]
pub(crate) fn _meetings<'py>(
    py: Python<'py>,
    scene: &Scene,
    vertices: &Bound<'py, PyAny>,
    origins: &Bound<'py, PyAny>,
    directions: &Bound<'py, PyAny>,
    most: usize,
    threads: Option<i64>,
) -> PyResult<Meetings<'py>> {
    let (pairs, world) = (Pairs::read(origins, directions)?, scene.world());
    let corners = Floats::read("vertices", vertices)?;
    if corners.row_count("vertices", 3)? != world.accel().mesh().positions().len() {
        return Err(refuse("vertices", "they are not those of the scene"));
    }
    let (corners, pool) = (corners.numbers()?, pool(py, threads)?);
    let rays = pairs.rays(world.origin)?;
    let meetings = find_meetings(py, &pool, world, corners, &rays, most)?;
    check(&rays, "ray_origins, ray_directions")?;
    gather(py, &meetings)
}

type Meetings<'py> = (Bound<'py, PyArray1<i64>>, Bound<'py, PyArray1<i64>>, Bound<'py, PyArray2<f64>>);

fn find_meetings(
    py: Python<'_>,
    pool: &ThreadPool,
    world: &World,
    corners: Numbers<'_>,
    rays: &RayRows<'_>,
    most: usize,
) -> PyResult<Vec<Found<Meeting>>> {
    let caster = world.caster();
    let triangles = caster.accel.mesh().triangles();
    // First all are traced, then placed: so the processor waits for many triangles at a time.
    batch::map(py, pool, rays.count(), |window| {
        let (mut found, mut pending) = (Found::with_capacity(window.len()), Vec::new());
        if most == 1 {
            let (mut batch, mut closest) = (Vec::new(), Vec::new());
            window.batches(|rows, first| {
                rays.read(first, rows.len(), &mut batch);
                caster.closest_many(&batch, &mut closest);
                found.counts.extend(closest.iter().map(|hit| u32::from(hit.is_some())));
                pending.extend((first..).zip(&closest).filter_map(|(index, hit)| Some((index, (*hit)?))));
                place_meetings(corners, triangles, rays, &pending, &mut found.things);
                pending.clear();
            });
            return found;
        }
        let mut hits = Vec::new();
        window.strides(|rows, first| {
            for index in (first..).take(rows.len()) {
                caster.all_hits(&rays.get(index), &mut hits);
                hits.truncate(most);
                pending.extend(hits.iter().map(|hit| (index, *hit)));
                found.counts.push(hits.len() as u32);
            }
            place_meetings(corners, triangles, rays, &pending, &mut found.things);
            pending.clear();
        });
        found
    })
}

fn gather<'py>(py: Python<'py>, meetings: &[Found<Meeting>]) -> PyResult<Meetings<'py>> {
    let count = meetings.iter().map(Found::len).sum();
    let (triangles, rays) = (zeros::<i64>(py, &[count])?, zeros::<i64>(py, &[count])?);
    let points = zeros::<f64>(py, &[count, 3])?;
    {
        let (mut triangles, mut rays) = (triangles.try_readwrite()?, rays.try_readwrite()?);
        let mut points = points.try_readwrite()?;
        let places = triangles.as_slice_mut()?.iter_mut().zip(rays.as_slice_mut()?);
        let places = places.zip(points.as_slice_mut()?.as_chunks_mut::<3>().0);
        let rows = meetings.iter().flat_map(Found::rows).enumerate();
        let all = rows.flat_map(|(ray, met)| met.iter().map(move |meeting| (ray, meeting)));
        for (((triangle, ray), point), (of_ray, meeting)) in places.zip(all) {
            (*triangle, *ray, *point) = (i64::from(meeting.triangle), of_ray as i64, meeting.point);
        }
    }
    Ok((triangles.cast_into()?, rays.cast_into()?, points.cast_into()?))
}

/// As many origins as directions.
struct Pairs<'py> {
    origins: Floats<'py>,
    directions: Floats<'py>,
    count: usize,
}

impl<'py> Pairs<'py> {
    fn read(origins: &Bound<'py, PyAny>, directions: &Bound<'py, PyAny>) -> PyResult<Self> {
        let (origins, directions) =
            (Floats::read("ray_origins", origins)?, Floats::read("ray_directions", directions)?);
        let count = origins.row_count("ray_origins", 3)?;
        let others = directions.row_count("ray_directions", 3)?;
        if count != others {
            return Err(refuse("ray_directions", format_args!("{others} directions for {count} origins")));
        }
        Ok(Self { origins, directions, count })
    }

    fn rays(&self, origin: [f64; 3]) -> PyResult<RayRows<'_>> {
        Ok(RayRows::pairs(self.origins.numbers()?, self.directions.numbers()?, origin))
    }

    fn many<T: numpy::Element>(
        &self,
        py: Python<'py>,
        world: &World,
        threads: Option<i64>,
        answer: impl Fn(&Caster, &[Ray], &mut [T]) + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (rays, pool) = (self.rays(world.origin)?, pool(py, threads)?);
        cast::many(py, &pool, world, &rays, &[self.count], "ray_origins, ray_directions", answer)
    }

    fn each<T: numpy::Element>(
        &self,
        py: Python<'py>,
        world: &World,
        threads: Option<i64>,
        answer: impl Fn(&Caster, &Ray, &mut Vec<Hit>) -> T + Sync,
    ) -> PyResult<Bound<'py, PyAny>> {
        let (rays, pool) = (self.rays(world.origin)?, pool(py, threads)?);
        cast::each(py, &pool, world, &rays, &[self.count], "ray_origins, ray_directions", answer)
    }
}
