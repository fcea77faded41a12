//! Counts of instructions, stored and compared.

use std::fmt::{self, Display, Formatter};
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::scenes::SceneError;

/// More than what a count changes by when the same work is laid out another way.
const TOLERANCE: f64 = 0.03;
/// Another compiler or C library does the same with other instructions.
const WIDE: f64 = 0.25;

/// The instructions of one loop.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Count {
    /// Which loop.
    pub name: String,
    /// How many it took.
    pub instructions: u64,
    /// For how many points, cells or others.
    pub done: u64,
    /// Which of these.
    pub of: String,
}

/// What counts depend on.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Conditions {
    /// Name and version of the compiler.
    pub compiler: String,
    /// Name and version of the C library: it allocates and copies memory.
    pub c_library: String,
    /// The architecture, and the vectors of its loops.
    pub processor: String,
}

impl Conditions {
    /// By how much, relative, a count may be above one that was stored under these; `None` where the two cannot be compared: with other
    /// vectors.
    pub fn tolerance(&self, now: &Self) -> Option<f64> {
        let tolerance = if self == now { TOLERANCE } else { WIDE };
        (self.processor == now.processor).then_some(tolerance)
    }
}

/// All loops.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Counts {
    /// What they were counted with.
    pub conditions: Conditions,
    /// In the order of the table.
    pub loops: Vec<Count>,
}

impl Counts {
    /// Counts as they were [written](Self::write).
    ///
    /// # Errors
    /// When the file cannot be read, or is none of counts.
    pub fn read(path: &Path) -> Result<Self, SceneError> {
        let file = fs::read_to_string(path).map_err(|error| format!("{}: {error}", path.display()))?;
        Self::from_json(&serde_json::from_str(&file)?)
            .ok_or_else(|| format!("{} holds no counts, make it anew with --record", path.display()).into())
    }

    /// Writes them as JSON, a loop a line.
    ///
    /// # Errors
    /// When the file cannot be written.
    pub fn write(&self, path: &Path) -> Result<(), SceneError> {
        let Conditions { compiler, c_library, processor } = &self.conditions;
        let (compiler, c_library, processor) = (json!(compiler), json!(c_library), json!(processor));
        let lines: Vec<String> = self.loops.iter().map(|count| format!("    {}", count.to_json())).collect();
        let loops = lines.join(",\n");
        let text = format!(
            "{{\n  \"compiler\": {compiler},\n  \"c_library\": {c_library},\n  \"processor\": {processor},\n  \
             \"loops\": [\n{loops}\n  ]\n}}\n"
        );
        Ok(fs::write(path, text)?)
    }

    fn from_json(value: &Value) -> Option<Self> {
        let text = |name: &str| Some(value.get(name)?.as_str()?.to_owned());
        let conditions = Conditions {
            compiler: text("compiler")?,
            c_library: text("c_library")?,
            processor: text("processor")?,
        };
        let loops = value.get("loops")?.as_array()?.iter().map(Count::from_json).collect::<Option<_>>()?;
        Some(Self { conditions, loops })
    }

    /// These, which are stored, beside those of now.
    pub fn compare<'a>(&'a self, now: &'a Self) -> Comparison<'a> {
        Comparison { stored: self, now }
    }
}

impl Count {
    /// The name first, which a map of JSON would not keep there.
    fn to_json(&self) -> String {
        let Self { name, instructions, done, of } = self;
        let (name, of) = (json!(name), json!(of));
        format!("{{ \"name\": {name}, \"instructions\": {instructions}, \"done\": {done}, \"of\": {of} }}")
    }

    fn from_json(value: &Value) -> Option<Self> {
        Some(Self {
            name: value.get("name")?.as_str()?.to_owned(),
            instructions: value.get("instructions")?.as_u64()?,
            done: value.get("done")?.as_u64()?,
            of: value.get("of")?.as_str()?.to_owned(),
        })
    }
}

/// Stored counts and those of now: a table, and whether all is well.
#[derive(Debug, Clone, Copy)]
pub struct Comparison<'a> {
    stored: &'a Counts,
    now: &'a Counts,
}

/// What became of the count of a loop.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Change {
    /// There is no stored count.
    New,
    /// The relative change.
    By(f64),
}

impl Comparison<'_> {
    /// Whether no count is above its stored one by more than the tolerance, and none is missing on either side. What cannot be compared
    /// passes.
    pub fn passes(&self) -> bool {
        let Some(tolerance) = self.tolerance() else { return true };
        let all = self.now.loops.iter().all(|count| !is_worse(self.change(count), tolerance));
        all && self.gone().next().is_none()
    }

    fn tolerance(&self) -> Option<f64> {
        self.stored.conditions.tolerance(&self.now.conditions)
    }

    fn stored(&self, name: &str) -> Option<&Count> {
        self.stored.loops.iter().find(|count| count.name == name)
    }

    fn change(&self, count: &Count) -> Change {
        self.stored(&count.name).map_or(Change::New, |stored| {
            Change::By(count.instructions as f64 / stored.instructions as f64 - 1.0)
        })
    }

    /// Loops that are stored and no longer there.
    fn gone(&self) -> impl Iterator<Item = &str> {
        let names = self.stored.loops.iter().map(|count| count.name.as_str());
        names.filter(|name| self.now.loops.iter().all(|count| count.name != *name))
    }
}

fn is_worse(change: Change, tolerance: f64) -> bool {
    match change {
        Change::New => true,
        // Not a number: a stored zero.
        Change::By(by) => by.is_nan() || by > tolerance,
    }
}

impl Display for Comparison<'_> {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(f, "| loop | of | instructions | for each | stored | change |\n|---|---|---|---|---|---|")?;
        for count in &self.now.loops {
            let (stored, change) = match (self.stored(&count.name), self.change(count)) {
                (Some(stored), Change::By(by)) => {
                    (stored.instructions.to_string(), format!("{:+.2} %", 100.0 * by))
                }
                _ => (String::new(), "not stored".to_owned()),
            };
            let Count { name, instructions, done, of } = count;
            let each = *instructions as f64 / *done as f64;
            writeln!(f, "| {name} | {done} × {of} | {instructions} | {each:.1} | {stored} | {change} |")?;
        }
        writeln!(f)?;
        self.verdict(f)
    }
}

impl Comparison<'_> {
    fn verdict(&self, f: &mut Formatter<'_>) -> fmt::Result {
        let (stored, now) = (&self.stored.conditions, &self.now.conditions);
        for (was, is) in [
            (&stored.compiler, &now.compiler),
            (&stored.c_library, &now.c_library),
            (&stored.processor, &now.processor),
        ] {
            if was == is {
                writeln!(f, "{is}")?;
            } else {
                writeln!(f, "{is}; the stored counts are of {was}")?;
            }
        }
        let Some(tolerance) = self.tolerance() else {
            return writeln!(f, "NOT CHECKED: other vectors take other instructions.");
        };
        writeln!(f, "tolerance: {:.0} %", 100.0 * tolerance)?;
        for count in &self.now.loops {
            let name = &count.name;
            match self.change(count) {
                Change::New => writeln!(f, "FAILED: {name} has no stored count, see --record")?,
                Change::By(by) if is_worse(Change::By(by), tolerance) => {
                    writeln!(f, "FAILED: {name} takes {:+.2} % instructions", 100.0 * by)?;
                }
                Change::By(by) if by < -tolerance => {
                    let by = 100.0 * by;
                    writeln!(f, "{name} takes {by:+.2} %: --record, or it may come back unseen")?;
                }
                Change::By(_) => {}
            }
        }
        for name in self.gone() {
            writeln!(f, "FAILED: {name} is stored but no loop, see --record")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn counts(of: &[(&str, u64)]) -> Counts {
        let count = |&(name, instructions): &(&str, u64)| Count {
            name: name.to_owned(),
            instructions,
            done: 10,
            of: "point".to_owned(),
        };
        let conditions = Conditions {
            compiler: "rustc 1.0".to_owned(),
            c_library: "glibc 1".to_owned(),
            processor: "x86_64, vectors: V3".to_owned(),
        };
        Counts { conditions, loops: of.iter().map(count).collect() }
    }

    #[test]
    fn more_than_the_tolerance_fails_and_fewer_is_told() {
        let stored = counts(&[("a", 1000), ("b", 1000)]);
        for (instructions, passes, told) in
            [(1029, true, "tolerance: 3 %"), (1031, false, "FAILED: b"), (900, true, "b takes -10.00 %")]
        {
            let now = counts(&[("a", 1000), ("b", instructions)]);
            let comparison = stored.compare(&now);
            assert_eq!(comparison.passes(), passes, "{instructions}");
            assert!(comparison.to_string().contains(told), "{comparison}");
        }
    }

    #[test]
    fn loops_on_one_side_alone_fail() {
        let (one, two) = (counts(&[("a", 1000)]), counts(&[("a", 1000), ("b", 1000)]));
        assert!(!one.compare(&two).passes());
        assert!(!two.compare(&one).passes());
        assert!(two.compare(&one).to_string().contains("b is stored but no loop"));
    }

    #[test]
    fn another_compiler_widens_the_tolerance_and_other_vectors_are_not_compared() {
        let stored = counts(&[("a", 1000)]);
        let mut now = counts(&[("a", 1200)]);
        assert!(!stored.compare(&now).passes());
        now.conditions.compiler = "rustc 2.0".to_owned();
        let comparison = stored.compare(&now);
        assert!(comparison.passes());
        let text = comparison.to_string();
        assert!(
            text.contains("rustc 2.0; the stored counts are of rustc 1.0") && text.contains("25 %"),
            "{text}"
        );
        now.loops[0].instructions = 9000;
        assert!(!stored.compare(&now).passes());
        now.conditions.processor = "x86_64, vectors: Scalar".to_owned();
        let comparison = stored.compare(&now);
        assert!(comparison.passes() && comparison.to_string().contains("NOT CHECKED"));
    }

    #[test]
    fn counts_are_read_as_they_were_written() {
        let path = std::env::temp_dir().join(format!("terrace-counts-{}.json", std::process::id()));
        let counts = counts(&[("a \"quoted\"", 1000), ("search for φ", u64::MAX)]);
        counts.write(&path).unwrap();
        let read = Counts::read(&path);
        fs::remove_file(&path).unwrap();
        assert_eq!(read.unwrap(), counts);
    }
}
