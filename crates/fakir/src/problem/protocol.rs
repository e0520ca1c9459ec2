//! Protocols: force or indentation over time.

use std::fmt;

/// The quantity that a segment of a [`Protocol`] prescribes.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Prescribed {
    /// The force, N.
    Force,
    /// The indentation, m.
    Indentation,
}

/// A part of a protocol: the quantity changes linearly from its value at the beginning. A hold is a segment to the present value, a step a
/// segment of no duration.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ProtocolSegment {
    /// The prescribed quantity.
    pub prescribed: Prescribed,
    /// Its value at the end, N or m.
    pub to: f64,
    /// Duration, s.
    pub duration: f64,
}

/// Why a protocol is invalid.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum InvalidProtocol {
    /// There are no segments.
    Empty,
    /// A duration that is negative or not finite, s.
    Duration(f64),
    /// A force that is negative or not finite, N.
    Force(f64),
    /// An indentation that is not finite, m.
    Indentation(f64),
}

impl fmt::Display for InvalidProtocol {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Empty => f.write_str("a protocol needs at least one segment"),
            Self::Duration(value) => {
                write!(f, "invalid duration {value} s: it must be 0 or greater")
            }
            Self::Force(value) => write!(
                f,
                "invalid force {value} N: without adhesion it must be 0 or greater"
            ),
            Self::Indentation(value) => {
                write!(f, "invalid indentation {value} m: it must be finite")
            }
        }
    }
}

impl std::error::Error for InvalidProtocol {}

/// Ramps and holds in force or indentation, in order. Before the first segment, the lens just touches the surface without force, and the
/// indentation is that of first touch.
///
/// ```
/// use fakir::problem::{Prescribed, Protocol};
///
/// // A force of 1 mN applied at once and held for ten minutes.
/// let hold = Protocol::step_and_hold(Prescribed::Force, 1e-3, 600.0)?;
/// assert_eq!(hold.duration(), 600.0);
/// # Ok::<(), fakir::problem::InvalidProtocol>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Protocol {
    segments: Vec<ProtocolSegment>,
}

impl Protocol {
    /// The segments in order.
    ///
    /// # Errors
    /// [`InvalidProtocol`]: no segments, a negative duration or force, or values that are not finite.
    pub fn new(segments: Vec<ProtocolSegment>) -> Result<Self, InvalidProtocol> {
        if segments.is_empty() {
            return Err(InvalidProtocol::Empty);
        }
        for segment in &segments {
            if !(segment.duration >= 0.0 && segment.duration.is_finite()) {
                return Err(InvalidProtocol::Duration(segment.duration));
            }
            match segment.prescribed {
                Prescribed::Force if !(segment.to >= 0.0 && segment.to.is_finite()) => {
                    return Err(InvalidProtocol::Force(segment.to));
                }
                Prescribed::Indentation if !segment.to.is_finite() => {
                    return Err(InvalidProtocol::Indentation(segment.to));
                }
                _ => {}
            }
        }
        Ok(Self { segments })
    }

    /// A step to a value, which is then held.
    ///
    /// # Errors
    /// As [`new`](Self::new).
    pub fn step_and_hold(
        prescribed: Prescribed,
        value: f64,
        duration: f64,
    ) -> Result<Self, InvalidProtocol> {
        let segment = |duration| ProtocolSegment {
            prescribed,
            to: value,
            duration,
        };
        Self::new(vec![segment(0.0), segment(duration)])
    }

    /// A table of times (s), which must increase, and values. The first value is reached at once.
    ///
    /// # Errors
    /// As [`new`](Self::new); [`InvalidProtocol::Duration`] for times that decrease.
    pub fn table(prescribed: Prescribed, rows: &[[f64; 2]]) -> Result<Self, InvalidProtocol> {
        let mut before = rows.first().map_or(0.0, |row| row[0]);
        let segments = rows.iter().map(|[time, value]| {
            let duration = time - before;
            before = *time;
            ProtocolSegment {
                prescribed,
                to: *value,
                duration,
            }
        });
        Self::new(segments.collect())
    }

    /// The segments.
    #[must_use]
    pub fn segments(&self) -> &[ProtocolSegment] {
        &self.segments
    }

    /// Duration of all segments, s.
    #[must_use]
    pub fn duration(&self) -> f64 {
        self.segments.iter().map(|segment| segment.duration).sum()
    }

    /// The largest prescribed value of a quantity, N or m; `None` if it is not prescribed.
    #[must_use]
    pub fn largest(&self, prescribed: Prescribed) -> Option<f64> {
        let segments = self.segments.iter();
        segments
            .filter(|segment| segment.prescribed == prescribed)
            .map(|segment| segment.to)
            .reduce(f64::max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn invalid_segments_are_refused() {
        let one = |prescribed, to, duration| {
            Protocol::new(vec![ProtocolSegment {
                prescribed,
                to,
                duration,
            }])
        };
        assert!(Protocol::new(Vec::new()).is_err());
        assert!(one(Prescribed::Force, -1e-6, 1.0).is_err());
        assert!(one(Prescribed::Force, f64::NAN, 1.0).is_err());
        assert!(one(Prescribed::Indentation, f64::INFINITY, 1.0).is_err());
        assert!(one(Prescribed::Indentation, -1e-6, 1.0).is_ok());
        for duration in [-1.0, f64::NAN, f64::INFINITY] {
            assert!(one(Prescribed::Force, 1e-6, duration).is_err());
        }
        assert!(Protocol::table(Prescribed::Force, &[[1.0, 1.0], [0.5, 1.0]]).is_err());
    }
}
