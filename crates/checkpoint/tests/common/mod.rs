//! Maps and their parts.

use terrace::{Mapper, Params, PoseNoise, Scan};
use terrace_synth::Scene;

pub fn room(points: usize, seed: u64) -> Vec<Scan> {
    let params = terrace_synth::Params { points: Some(points), sigma: None, seed };
    Scene::room().generate(&params).unwrap().scans.into_iter().map(|scan| scan.scan).collect()
}

/// A map that forgets its points. Every third pose is uncertain.
pub fn map(params: Params, scans: &[Scan]) -> Mapper {
    let mut mapper = Mapper::streaming(params).unwrap();
    let noise = PoseNoise::from_radians(0.01, 0.001 / 3.0).unwrap();
    for (number, scan) in scans.iter().enumerate() {
        let noise = (number % 3 == 0 && scan.sensor_position().is_some()).then_some(noise);
        mapper.insert_from(scan, noise).unwrap();
    }
    mapper
}

pub fn file(mapper: &Mapper) -> Vec<u8> {
    let mut file = Vec::new();
    terrace_checkpoint::write_map(mapper, &mut file).unwrap();
    file
}

/// Everything of a map: `Debug` prints the shortest decimals that are no other number, and tells 0 from −0.
pub fn all(mapper: &Mapper) -> Vec<String> {
    let parts = mapper.parts().unwrap();
    let head = format!("{:?} {:?} {:?}", mapper.params(), mapper.chosen_cell_size(), mapper.views());
    std::iter::once(head).chain(parts.cells().map(|cell| format!("{cell:?}"))).collect()
}
