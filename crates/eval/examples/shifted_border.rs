//! Two planes of 100 points each that meet at a border; the border is found further and further off.

use terrace_eval::{Contingency, EvalError};
use terrace_types::PlaneId;

fn main() -> Result<(), EvalError> {
    let split_at = |border: u32| (0..200).map(|point| PlaneId::new(1 + u32::from(point >= border))).collect();
    let truth: Vec<Option<PlaneId>> = split_at(100);
    println!("points off   cover   F1 at 0.5   F1 at 0.8");
    for off in [0, 5, 10, 20, 40, 80] {
        let found: Vec<Option<PlaneId>> = split_at(100 + off);
        let both = Contingency::new(&truth, &found)?;
        let f1 = |at| Ok::<_, EvalError>(both.matches(at)?.f1().unwrap_or(0.0));
        println!(
            "{off:>10}   {:.3}   {:>9.3}   {:>9.3}",
            both.weighted_cover().unwrap_or(0.0),
            f1(0.5)?,
            f1(0.8)?
        );
    }
    Ok(())
}
