//! Scans the room and prints its planes and what was seen of them.

use terrace_synth::{Params, Scene, SynthError};

fn main() -> Result<(), SynthError> {
    let room = Scene::room().generate(&Params::default())?;
    println!("{} points in {} scans", room.points(), room.scans.len());
    println!("{:>3}  {:<16} {:>7}  {:>8} {:>8} {:>8} {:>8}", "id", "plane", "points", "a", "b", "c", "d");
    for plane in &room.planes {
        let [a, b, c, d] = plane.plane.coefficients();
        println!(
            "{:>3}  {:<16} {:>7}  {a:>8.4} {b:>8.4} {c:>8.4} {d:>8.4}",
            plane.id, plane.name, plane.points
        );
    }
    let labelled: usize = room.planes.iter().map(|plane| plane.points).sum();
    println!("{:>3}  {:<16} {:>7}", "", "no plane", room.points() - labelled);
    Ok(())
}
