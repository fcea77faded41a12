//! One colour for each plane.

use terrace_types::PlaneId;

/// The colour of points that belong to no plane.
pub const UNLABELLED: [u8; 3] = [203, 203, 203];

/// Share of the circle between the hues of neighbouring identities: one minus the golden ratio's inverse, whose
/// multiples stay as far apart as possible however many there are.
const HUE_STEP: f64 = 0.381_966_011_250_105;

/// Lightness and saturation, taken in turn so that hues that come close differ in these.
const TONES: [[f64; 2]; 3] = [[0.56, 0.68], [0.42, 0.72], [0.70, 0.74]];

/// The colour of a plane: the same identity always has the same colour, and small identities differ clearly.
///
/// ```
/// use terrace_draw::colour;
/// use terrace_types::PlaneId;
///
/// let [one, two] = [1, 2].map(|n| colour(PlaneId::new(n).unwrap()));
/// assert_ne!(one, two);
/// ```
pub fn colour(plane: PlaneId) -> [u8; 3] {
    let index = plane.index();
    let hue = (0.58 + HUE_STEP * index as f64).fract();
    let [lightness, saturation] = TONES[index % TONES.len()];
    hsl(hue, saturation, lightness)
}

/// The colour of a label: that of its plane, or [`UNLABELLED`].
pub fn label_colour(label: Option<PlaneId>) -> [u8; 3] {
    label.map_or(UNLABELLED, colour)
}

/// From hue, saturation and lightness, each from 0 to 1.
fn hsl(hue: f64, saturation: f64, lightness: f64) -> [u8; 3] {
    let amplitude = saturation * lightness.min(1.0 - lightness);
    [0.0, 8.0, 4.0].map(|offset| {
        let k = (offset + 12.0 * hue) % 12.0;
        to_byte(lightness - amplitude * (k - 3.0).min(9.0 - k).clamp(-1.0, 1.0))
    })
}

/// A channel from 0 to 1 as a byte; what lies outside is cut off.
#[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "clamped to 0..=255")]
pub(crate) fn to_byte(channel: f64) -> u8 {
    (channel * 255.0).round().clamp(0.0, 255.0) as u8
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_twenty_colours_are_well_apart_and_unlike_unlabelled() {
        let mut colours = vec![UNLABELLED];
        colours.extend((0..20).map(|i| colour(PlaneId::from_index(i).unwrap())));
        for (i, a) in colours.iter().enumerate() {
            for b in &colours[..i] {
                let apart: i32 = a.iter().zip(b).map(|(x, y)| (i32::from(*x) - i32::from(*y)).pow(2)).sum();
                assert!(apart > 500, "{a:?} {b:?}");
            }
        }
    }

    #[test]
    fn known_hues() {
        assert_eq!(hsl(0.0, 1.0, 0.5), [255, 0, 0]);
        assert_eq!(hsl(1.0 / 3.0, 1.0, 0.5), [0, 255, 0]);
        assert_eq!(hsl(0.7, 0.0, 1.0), [255, 255, 255]);
    }
}
