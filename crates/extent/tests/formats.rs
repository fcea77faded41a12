//! What is written is what other libraries read.
#![allow(clippy::unwrap_used, clippy::float_cmp, reason = "tests")]

use std::collections::HashSet;

use ply_rs_bw::{parser::Parser, ply::DefaultElement, ply::Property};
use terrace_extent::{Footprint, Mesh, OutlineOptions, PlaneExtent, PlaneFrame};
use terrace_types::Plane;

const FAR: [f64; 3] = [5e5, 5e6, 120.0];
const COLOURS: [[u8; 3]; 2] = [[255, 0, 188], [10, 200, 30]];

/// Plates of 2 × 2 m with a hole, far from the origin: a floor and a wall.
fn extents() -> [PlaneExtent; 2] {
    [[0.0, 0.0, 1.0], [-0.6, 0.8, 0.0]].map(|normal| {
        let frame = PlaneFrame::new(&Plane::through(FAR, normal).unwrap(), FAR).unwrap();
        let mut footprint = Footprint::new(frame, 0.05).unwrap();
        for i in -20..20 {
            for j in -20..20 {
                let p = [f64::from(i) * 0.05 + 0.02, f64::from(j) * 0.05 + 0.02];
                if p[0].hypot(p[1]) > 0.5 {
                    footprint.add(frame.to_world(p)).unwrap();
                }
            }
        }
        PlaneExtent::of(&footprint, &OutlineOptions::closing(0.1)).unwrap()
    })
}

fn mesh() -> Mesh {
    let mut mesh = Mesh::new();
    for (extent, colour) in extents().iter().zip(COLOURS) {
        mesh.add(extent, colour).unwrap();
    }
    mesh
}

fn colour_of(mesh: &Mesh, k: usize) -> [u8; 3] {
    // The wall comes second; its vertices are the half, for both have the same polygon.
    COLOURS[usize::from(k >= mesh.positions().len() / 2)]
}

#[test]
fn ply() {
    let mesh = mesh();
    let mut bytes = Vec::new();
    mesh.write_ply(&mut bytes).unwrap();
    let read = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    let vertices = &read.payload["vertex"];
    assert_eq!(vertices.len(), mesh.positions().len());
    for (k, (vertex, position)) in vertices.iter().zip(mesh.positions()).enumerate() {
        for (name, value) in ["x", "y", "z"].iter().zip(position) {
            assert_eq!(vertex[*name], Property::Double(*value));
        }
        for (name, value) in ["red", "green", "blue"].iter().zip(colour_of(&mesh, k)) {
            assert_eq!(vertex[*name], Property::UChar(value));
        }
    }
    for (face, triangle) in read.payload["face"].iter().zip(mesh.triangles()) {
        let indices = triangle.map(|k| i32::try_from(k).unwrap()).to_vec();
        assert_eq!(face["vertex_indices"], Property::ListInt(indices));
    }
    assert_eq!(read.payload["face"].len(), mesh.triangles().len());
}

#[test]
fn obj() {
    let mesh = mesh();
    let mut bytes = Vec::new();
    mesh.write_obj(&mut bytes).unwrap();
    let text = String::from_utf8(bytes.clone()).unwrap();
    // tobj reads single precision: the digits are checked on the text.
    let positions: Vec<[f64; 3]> = text
        .lines()
        .filter_map(|line| line.strip_prefix("v "))
        .map(|line| {
            let numbers: Vec<f64> = line.split(' ').map(|x| x.parse().unwrap()).collect();
            [numbers[0], numbers[1], numbers[2]]
        })
        .collect();
    assert_eq!(positions, mesh.positions());
    let (models, _) =
        tobj::load_obj_buf(&mut bytes.as_slice(), &tobj::LoadOptions::default(), |_| Ok(Default::default()))
            .unwrap();
    assert_eq!(models.iter().map(|m| m.name.as_str()).collect::<Vec<_>>(), ["plane_1", "plane_2"]);
    let triangles: usize = models.iter().map(|m| m.mesh.indices.len() / 3).sum();
    assert_eq!(triangles, mesh.triangles().len());
    for (model, colour) in models.iter().zip(COLOURS) {
        for read in model.mesh.vertex_color.as_chunks::<3>().0 {
            assert!((0..3).all(|i| (read[i] * 255.0 - f32::from(colour[i])).abs() < 0.05));
        }
        assert_eq!(model.mesh.vertex_color.len(), model.mesh.positions.len());
    }
}

#[test]
fn glb() {
    let mesh = mesh();
    let mut bytes = Vec::new();
    mesh.write_glb(&mut bytes).unwrap();
    assert_eq!(bytes.len() % 4, 0);
    // Validates the document as it reads.
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = blob.unwrap();
    let root = document.default_scene().unwrap().nodes().next().unwrap();
    let node = root.children().next().unwrap();
    let (translation, _, _) = node.transform().decomposed();
    assert_eq!(translation.map(f64::from), [5e5, 5e6, 120.0]);
    // z up becomes y up.
    let turn = root.transform().matrix();
    assert!((turn[2][1] - 1.0).abs() < 1e-6 && (turn[1][2] + 1.0).abs() < 1e-6);
    let primitive = node.mesh().unwrap().primitives().next().unwrap();
    assert!(primitive.material().double_sided());
    let reader = primitive.reader(|_| Some(&blob));
    let positions: Vec<[f32; 3]> = reader.read_positions().unwrap().collect();
    assert_eq!(positions.len(), mesh.positions().len());
    for (read, position) in positions.iter().zip(mesh.positions()) {
        assert!((0..3).all(|i| (f64::from(read[i]) + FAR[i] - position[i]).abs() < 1e-6));
    }
    let bounds = primitive.bounding_box();
    for i in 0..3 {
        let along = positions.iter().map(|p| p[i]);
        assert_eq!(bounds.min[i], along.clone().fold(f32::INFINITY, f32::min));
        assert_eq!(bounds.max[i], along.fold(f32::NEG_INFINITY, f32::max));
    }
    let indices: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
    assert_eq!(indices, mesh.triangles().concat());
    let colours: Vec<[u8; 4]> = reader.read_colors(0).unwrap().into_rgba_u8().collect();
    // 188 of 255 is half the light.
    assert_eq!((colours[0], colours.len()), ([255, 0, 128, 255], positions.len()));
    let normals: HashSet<[u32; 3]> = reader.read_normals().unwrap().map(|n| n.map(f32::to_bits)).collect();
    assert_eq!(normals.len(), 2);
}

#[test]
fn a_mesh_of_nothing() {
    let mesh = Mesh::new();
    let mut bytes = Vec::new();
    mesh.write_glb(&mut bytes).unwrap();
    assert_eq!(gltf::Gltf::from_slice(&bytes).unwrap().meshes().count(), 0);
    bytes.clear();
    mesh.write_ply(&mut bytes).unwrap();
    let read = Parser::<DefaultElement>::new().read_ply(&mut bytes.as_slice()).unwrap();
    assert!(read.payload["vertex"].is_empty());
}

#[test]
fn json() {
    let [floor, _] = extents();
    let value = serde_json::to_value(&floor).unwrap();
    assert_eq!(value["polygons"]["type"], "MultiPolygon");
    assert_eq!(value["frame"]["normal"], serde_json::json!([0.0, 0.0, 1.0]));
    assert_eq!(value["area"].as_f64(), Some(floor.area()));
    let flat = value["polygons"]["coordinates"][0].as_array().unwrap();
    let world = value["world"][0].as_array().unwrap();
    assert_eq!((flat.len(), world.len()), (2, 2));
    for (flat, world) in flat.iter().zip(world) {
        let (flat, world) = (flat.as_array().unwrap(), world.as_array().unwrap());
        assert_eq!(flat.len(), world.len());
        assert!(flat.first() == flat.last() && flat.len() > 3);
        for (p, q) in flat.iter().zip(world) {
            let p = floor.frame().to_world([0, 1].map(|i| p[i].as_f64().unwrap()));
            assert!((0..3).all(|i| q[i].as_f64() == Some(p[i])));
        }
    }
}
