//! Colours that remain distinguishable with colour blindness and in print.
//!
//! Lines: M. Okabe, K. Ito, Color Universal Design (2008). Maps: viridis, perceptually uniform and
//! monotonic in luminance (S. van der Walt, N. Smith, A Better Default Colormap for Matplotlib,
//! 2015).

use crate::scene::{Colour, Fill};

/// Colour of a line or a marker.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[allow(missing_docs)] // the names are explicit
pub enum Tint {
    Blue,
    Vermillion,
    Green,
    Purple,
    Orange,
    Sky,
    Black,
    Grey,
}

impl Tint {
    /// Colours in order of distinguishability, the best first.
    pub(crate) const ORDER: [Self; 7] = [
        Self::Blue,
        Self::Vermillion,
        Self::Green,
        Self::Purple,
        Self::Orange,
        Self::Sky,
        Self::Black,
    ];

    pub(crate) fn colour(self) -> Colour {
        match self {
            Self::Blue => Colour([0, 114, 178]),
            Self::Vermillion => Colour([213, 94, 0]),
            Self::Green => Colour([0, 158, 115]),
            Self::Purple => Colour([204, 121, 167]),
            Self::Orange => Colour([230, 159, 0]),
            Self::Sky => Colour([86, 180, 233]),
            Self::Black => Colour::BLACK,
            Self::Grey => Colour::grey(130),
        }
    }
}

/// Colour map, dark for the smallest values.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum ColourMap {
    Viridis,
    /// Black to white.
    Grey,
}

impl ColourMap {
    /// Colour of a value from 0 to 1; outside this range, the colour of the nearer end.
    pub(crate) fn at(self, value: f64) -> Colour {
        let value = if value.is_finite() { value } else { 0.0 }.clamp(0.0, 1.0);
        match self {
            Self::Grey => Colour::grey((255.0 * value).round() as u8),
            Self::Viridis => {
                let colorous::Color { r, g, b } = colorous::VIRIDIS.eval_continuous(value);
                Colour([r, g, b])
            }
        }
    }

    /// Fill from the smallest value at the bottom to the largest at the top.
    pub(crate) fn fill(self) -> Fill {
        const STEPS: u32 = 48;
        Fill::Gradient(
            (0..=STEPS)
                .map(|k| self.at(f64::from(k) / f64::from(STEPS)))
                .collect(),
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_rise_in_luminance_and_use_the_range() {
        for map in [ColourMap::Viridis, ColourMap::Grey] {
            let luminance: Vec<f64> = (0..=50)
                .map(|k| map.at(f64::from(k) / 50.0).luminance())
                .collect();
            assert!(
                luminance.windows(2).all(|pair| pair[1] > pair[0]),
                "{map:?}"
            );
            assert!(luminance[50] - luminance[0] > 0.5, "{map:?}");
        }
    }

    #[test]
    fn lines_contrast_with_paper() {
        // W3C Web Content Accessibility Guidelines 2.1, 1.4.11, require a contrast ratio of 3 for
        // graphical objects. The two lightest tints come last and are never the only distinction.
        for tint in &Tint::ORDER[..3] {
            let contrast = 1.05 / (tint.colour().luminance() + 0.05);
            assert!(contrast > 3.0, "{tint:?}: {contrast}");
        }
    }
}
