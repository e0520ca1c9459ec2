//! The clock of computing times and progress. WebAssembly has no clock of its own: there the page supplies one.

use std::sync::{LazyLock, OnceLock};
use std::time::{Duration, Instant};

/// Clock of the page, s since any origin.
static SUPPLIED: OnceLock<fn() -> f64> = OnceLock::new();

/// Origin of the clock of the system.
static ORIGIN: LazyLock<Instant> = LazyLock::new(Instant::now);

/// Uses the given clock (s since any origin) from now on, where the system has none. Only the first call has an effect.
pub fn supply_clock(clock: fn() -> f64) {
    let _ = SUPPLIED.set(clock);
}

/// A moment, as a time since the origin of the clock.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment(Duration);

impl Moment {
    pub(crate) fn now() -> Self {
        Self(match SUPPLIED.get() {
            Some(clock) => Duration::try_from_secs_f64(clock()).unwrap_or_default(),
            None => ORIGIN.elapsed(),
        })
    }

    pub(crate) fn elapsed(self) -> Duration {
        Self::now().since(self)
    }

    /// Zero if `earlier` is later.
    pub(crate) fn since(self, earlier: Self) -> Duration {
        self.0.saturating_sub(earlier.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn time_passes_and_never_runs_backwards() {
        let start = Moment::now();
        std::thread::sleep(Duration::from_millis(2));
        assert!(start.elapsed() >= Duration::from_millis(2));
        assert_eq!(start.since(Moment::now()), Duration::ZERO);
    }
}
