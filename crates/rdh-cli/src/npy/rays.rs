//! Rays in an array file: `(…, 6)` origins and directions, or `(…, 8)` with `t_min` and `t_max`.

use std::fs::File;
use std::io::{BufReader, Read, Seek, SeekFrom};
use std::path::Path;

use anyhow::{Context as _, Result, ensure};
use rdh::Ray;

use super::{Header, Number};

/// An open file of rays.
#[derive(Debug)]
pub(crate) struct RayFile {
    header: Header,
    input: BufReader<File>,
    /// The shape without its last side: one answer each.
    pub shape: Vec<u64>,
    /// How many rays there are.
    pub len: u64,
    columns: usize,
    origin: [f64; 3],
}

impl RayFile {
    /// Opens a file; its length must be that of its array. Rays are given in world coordinates, and read relative to `origin`.
    pub(crate) fn open(path: &Path, origin: [f64; 3]) -> Result<Self> {
        let named = || path.display().to_string();
        // Asked before opening, since opening a pipe waits for its writer.
        let about = std::fs::metadata(path).with_context(named)?;
        ensure!(about.is_file(), "{} is not a file", named());
        let mut input = BufReader::with_capacity(1 << 20, File::open(path).with_context(named)?);
        let header = Header::read(&mut input).with_context(named)?;
        Self::new(header, input, about.len(), origin).with_context(named)
    }

    fn new(header: Header, input: BufReader<File>, file_len: u64, origin: [f64; 3]) -> Result<Self> {
        let (columns, shape) = match header.shape.split_last() {
            Some((6, shape)) => (6, shape.to_vec()),
            Some((8, shape)) => (8, shape.to_vec()),
            _ => anyhow::bail!("an array of shape {:?}; rays need (n, 6) or (n, 8)", header.shape),
        };
        let row = (columns * header.number.size()) as u64;
        let len = shape.iter().try_fold(1u64, |product, &side| product.checked_mul(side));
        let expected = len.and_then(|len| len.checked_mul(row)?.checked_add(header.length));
        ensure!(
            expected == Some(file_len),
            "{file_len} bytes; an array of shape {:?} needs {}",
            header.shape,
            expected.map_or_else(|| "more than there can be".to_owned(), |n| n.to_string())
        );
        let len = len.unwrap_or(0);
        Ok(Self { header, input, shape, len, columns, origin })
    }

    /// Goes to a ray.
    pub(crate) fn seek(&mut self, ray: u64) -> Result<()> {
        let row = (self.columns * self.header.number.size()) as u64;
        self.input.seek(SeekFrom::Start(self.header.length + ray * row))?;
        Ok(())
    }

    /// Reads the next `count` rays into `rays`.
    pub(crate) fn read(&mut self, count: usize, rays: &mut Vec<Ray>) -> Result<()> {
        let (number, big_endian) = (self.header.number, self.header.big_endian);
        let mut bytes = vec![0; count * self.columns * number.size()];
        self.input.read_exact(&mut bytes).context("the file of rays has become shorter")?;
        rays.clear();
        rays.extend(bytes.chunks_exact(self.columns * number.size()).map(|row| {
            let mut values = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, f64::INFINITY];
            for (value, bytes) in values.iter_mut().zip(row.chunks_exact(number.size())) {
                *value = decode(bytes, number, big_endian);
            }
            // The difference is taken before numbers are made short.
            let origin = |a: usize| values[a] - self.origin[a];
            let [x, y, z] = [origin(0), origin(1), origin(2)];
            let [_, _, _, dx, dy, dz, t_min, t_max] = values;
            Ray::from([x, y, z, dx, dy, dz, t_min, t_max].map(|x| x as f32))
        }));
        Ok(())
    }
}

fn decode(bytes: &[u8], number: Number, big_endian: bool) -> f64 {
    let word = |bytes: &[u8]| {
        let word = bytes.iter().fold(0, |word, &b| word << 8 | u64::from(b));
        if big_endian { word } else { word.swap_bytes() >> (64 - 8 * bytes.len()) }
    };
    match number {
        Number::F32 => f64::from(f32::from_bits(word(bytes) as u32)),
        Number::F64 => f64::from_bits(word(bytes)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::npy::header;

    fn file(descr: &str, shape: &[u64], numbers: &[u8]) -> tempfile::NamedTempFile {
        let mut file = tempfile::NamedTempFile::new().unwrap();
        header::write(&mut file, descr, shape).unwrap();
        std::io::Write::write_all(&mut file, numbers).unwrap();
        file
    }

    #[test]
    fn all_numbers_are_read_alike() {
        let values = [1.5f64, 2.0, -3.0, 0.0, 1.0, -0.0, 0.25, 1e30];
        let f4_le: Vec<u8> = values.iter().flat_map(|&x| (x as f32).to_le_bytes()).collect();
        let f4_be: Vec<u8> = values.iter().flat_map(|&x| (x as f32).to_be_bytes()).collect();
        let f8_le: Vec<u8> = values.iter().flat_map(|x| x.to_le_bytes()).collect();
        let f8_be: Vec<u8> = values.iter().flat_map(|x| x.to_be_bytes()).collect();
        for (descr, bytes) in [("'<f4'", f4_le), ("'>f4'", f4_be), ("'<f8'", f8_le), ("'>f8'", f8_be)] {
            let twice = [bytes.clone(), bytes].concat();
            let file = file(descr, &[2, 8], &twice);
            let mut found = RayFile::open(file.path(), [0.5, 0.0, 0.0]).unwrap();
            assert_eq!((found.len, &found.shape[..]), (2, &[2][..]));
            let mut rays = Vec::new();
            found.seek(1).unwrap();
            found.read(1, &mut rays).unwrap();
            assert_eq!(rays, [Ray::from([1.0, 2.0, -3.0, 0.0, 1.0, -0.0, 0.25, 1e30])], "{descr}");
        }
    }

    #[test]
    fn six_numbers_are_a_half_line() {
        let bytes: Vec<u8> = (1..7).flat_map(|x| (x as f32).to_le_bytes()).collect();
        let mut rays = Vec::new();
        RayFile::open(file("'<f4'", &[1, 1, 6], &bytes).path(), [0.0; 3]).unwrap().read(1, &mut rays).unwrap();
        assert_eq!(rays, [Ray::new([1.0, 2.0, 3.0], [4.0, 5.0, 6.0])]);
    }

    #[test]
    fn shapes_that_do_not_fit_are_errors() {
        for (shape, bytes) in
            [(&[1, 7][..], 28), (&[8], 31), (&[2, 8], 32), (&[0, 8], 4), (&[u64::MAX, u64::MAX, 8], 0)]
        {
            assert!(RayFile::open(file("'<f4'", shape, &vec![0; bytes]).path(), [0.0; 3]).is_err(), "{shape:?}");
        }
        assert_eq!(RayFile::open(file("'<f4'", &[0, 8], &[]).path(), [0.0; 3]).unwrap().len, 0);
        assert!(RayFile::open(Path::new("."), [0.0; 3]).unwrap_err().to_string().contains("not a file"));
    }
}
