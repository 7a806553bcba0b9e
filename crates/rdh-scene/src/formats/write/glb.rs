//! glTF 2.0 in one binary file: one mesh, one node, which carries the origin. Coordinates are kept as they are, whichever way is up.

use std::fs::File;
use std::io::{self, BufWriter, Write};

use rdh::Aabb;
use serde_json::{Value, json};

use super::Placed;

const FLOAT: u32 = 5126;
const UNSIGNED_INT: u32 = 5125;

pub(super) fn write(placed: &Placed<'_>, out: &mut BufWriter<File>) -> io::Result<()> {
    let mesh = placed.mesh;
    let numbers = if mesh.is_empty() { 0 } else { mesh.positions().len() + mesh.len() };
    let mut json = document(placed).to_string();
    // Chunks are whole words; the rest of a text is blanks.
    json.push_str(&" ".repeat(json.len().next_multiple_of(4) - json.len()));
    let (binary, too_large) = (12 * numbers, || io::Error::other("GLB files hold at most 4 GiB"));
    let length = u32::try_from(12 + 8 + json.len() + 8 + binary).map_err(|_| too_large())?;
    out.write_all(b"glTF")?;
    [2, length, json.len() as u32].iter().try_for_each(|word| out.write_all(&word.to_le_bytes()))?;
    out.write_all(b"JSON")?;
    out.write_all(json.as_bytes())?;
    out.write_all(&(binary as u32).to_le_bytes())?;
    out.write_all(b"BIN\0")?;
    if numbers == 0 {
        return Ok(());
    }
    mesh.positions().as_flattened().iter().try_for_each(|x| out.write_all(&x.to_le_bytes()))?;
    mesh.triangles().as_flattened().iter().try_for_each(|i| out.write_all(&i.to_le_bytes()))
}

fn document(placed: &Placed<'_>) -> Value {
    let mesh = placed.mesh;
    let asset = json!({ "version": "2.0", "generator": concat!("rdh ", env!("CARGO_PKG_VERSION")) });
    // Accessors must not be empty.
    if mesh.is_empty() {
        return json!({ "asset": asset, "scene": 0, "scenes": [{}] });
    }
    let (vertices, indices) = (mesh.positions().len(), 3 * mesh.len());
    let bounds = Aabb::around(mesh.positions());
    json!({
        "asset": asset,
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0, "translation": placed.origin }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "accessors": [
            { "bufferView": 0, "componentType": FLOAT, "count": vertices, "type": "VEC3", "min": bounds.min, "max": bounds.max },
            { "bufferView": 1, "componentType": UNSIGNED_INT, "count": indices, "type": "SCALAR" },
        ],
        "bufferViews": [
            { "buffer": 0, "byteOffset": 0, "byteLength": 12 * vertices, "target": 34962 },
            { "buffer": 0, "byteOffset": 12 * vertices, "byteLength": 4 * indices, "target": 34963 },
        ],
        "buffers": [{ "byteLength": 12 * vertices + 4 * indices }],
    })
}
