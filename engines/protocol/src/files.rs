//! Mesh and ray files, as the driver writes them, and answers, as it reads them. All little-endian.
//!
//! ```text
//! mesh:     "RDH-MESH"  u64 vertices  u64 triangles  f32 x y z …  u32 a b c …
//! rays:     "RDH-CAST"  u64 rays  f32 ox oy oz dx dy dz t_min t_max …
//! answers:  f32 t …     of each ray; infinite for a miss, 0 for an occlusion
//! ```

use std::path::Path;

use anyhow::{Context, Result, bail, ensure};

use crate::engine::Ray;

/// A triangle mesh.
#[derive(Debug)]
pub struct Mesh {
    /// Vertices.
    pub positions: Vec<[f32; 3]>,
    /// Corners, as indices of vertices; in range.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// The corners of each triangle, in order.
    pub fn corners(&self) -> impl Iterator<Item = [[f32; 3]; 3]> {
        self.triangles.iter().map(|t| t.map(|i| self.positions[i as usize]))
    }
}

/// Reads a mesh file; indices are in range afterwards.
pub(crate) fn read_mesh(path: &Path) -> Result<Mesh> {
    read(path, |data| {
        let (counts, body) = header::<2>(data, b"RDH-MESH", [12, 12])?;
        let (positions, triangles) = body.split_at(counts[0] * 12);
        let positions: Vec<_> = floats(positions).collect();
        let triangles: Vec<[u32; 3]> = numbers(triangles).map(|t| t.map(u32::from_le_bytes)).collect();
        let wrong = triangles.iter().position(|t| t.iter().any(|&i| i as usize >= positions.len()));
        match wrong {
            Some(triangle) => bail!("triangle {triangle}: index out of range"),
            None => Ok(Mesh { positions, triangles }),
        }
    })
}

/// Reads a ray file.
pub(crate) fn read_rays(path: &Path) -> Result<Vec<Ray>> {
    read(path, |data| {
        let (_, body) = header::<1>(data, b"RDH-CAST", [32])?;
        let ray = |[ox, oy, oz, dx, dy, dz, t_min, t_max]: [f32; 8]| Ray {
            origin: [ox, oy, oz],
            direction: [dx, dy, dz],
            t_min,
            t_max,
        };
        Ok(floats(body).map(ray).collect())
    })
}

/// Writes each ray's answer.
pub(crate) fn write_answers(path: &Path, answers: &[f32]) -> Result<()> {
    let bytes: Vec<u8> = answers.iter().flat_map(|t| t.to_le_bytes()).collect();
    std::fs::write(path, bytes).with_context(|| path.display().to_string())
}

fn read<T>(path: &Path, parse: impl FnOnce(&[u8]) -> Result<T>) -> Result<T> {
    let data = std::fs::read(path).with_context(|| path.display().to_string())?;
    parse(&data).with_context(|| path.display().to_string())
}

/// Counts of a header, once the file is known to hold exactly as many items of these sizes; and what follows.
fn header<'a, const N: usize>(data: &'a [u8], magic: &[u8; 8], sizes: [usize; N]) -> Result<([usize; N], &'a [u8])> {
    let begins = 8 + 8 * N;
    ensure!(data.len() >= begins && data.starts_with(magic), "byte 0: no {} file", magic.escape_ascii());
    let word = |i: usize| u64::from_le_bytes(std::array::from_fn(|b| data[8 + 8 * i + b]));
    let (mut counts, mut length) = ([0; N], Some(begins));
    for i in 0..N {
        counts[i] = usize::try_from(word(i)).unwrap_or(usize::MAX);
        length = length.and_then(|sum| sum.checked_add(counts[i].checked_mul(sizes[i])?));
    }
    ensure!(length == Some(data.len()), "byte 8: the counts {counts:?} don't make {} bytes", data.len());
    Ok((counts, &data[begins..]))
}

fn floats<const N: usize>(data: &[u8]) -> impl Iterator<Item = [f32; N]> {
    numbers(data).map(|item| item.map(f32::from_le_bytes))
}

fn numbers<const N: usize>(data: &[u8]) -> impl Iterator<Item = [[u8; 4]; N]> {
    data.as_chunks::<4>().0.as_chunks::<N>().0.iter().copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn mesh_bytes(vertices: u64, triangles: u64, floats: usize, indices: &[u32]) -> Vec<u8> {
        let mut out = b"RDH-MESH".to_vec();
        out.extend([vertices, triangles].map(u64::to_le_bytes).as_flattened());
        (0..floats).for_each(|i| out.extend((i as f32).to_le_bytes()));
        indices.iter().for_each(|i| out.extend(i.to_le_bytes()));
        out
    }

    fn parse(data: &[u8]) -> Result<Mesh> {
        let path = std::env::temp_dir().join(format!("rdh-engine-{}-{}", std::process::id(), data.len()));
        std::fs::write(&path, data)?;
        let mesh = read_mesh(&path);
        std::fs::remove_file(&path)?;
        mesh
    }

    #[test]
    fn a_mesh_is_read_and_a_wrong_one_refused() {
        let good = mesh_bytes(3, 1, 9, &[0, 1, 2]);
        let mesh = parse(&good).unwrap();
        assert_eq!((mesh.positions[2], mesh.triangles[0]), ([6.0, 7.0, 8.0], [0, 1, 2]));
        for bad in [
            mesh_bytes(3, 1, 9, &[0, 1, 3]),
            mesh_bytes(3, 2, 9, &[0, 1, 2]),
            mesh_bytes(u64::MAX, 1, 9, &[0, 1, 2]),
            good[..good.len() - 1].to_vec(),
            b"RDH-MESH".to_vec(),
            vec![],
        ] {
            assert!(parse(&bad).is_err());
        }
    }
}
