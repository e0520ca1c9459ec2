//! Threads that share work, and the flag that stops it.

use rayon::prelude::*;
use std::num::NonZero;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// A flag that asks a running computation to stop.
///
/// Clones share the flag. The solvers look at it at every iteration.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Asks the computation to stop.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether it was asked to.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// Threads to share work between: as many as were asked for, but no more than there are processors.
/// More would only wait for each other, and thousands of them take long to start.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Threads {
    asked: usize,
    processors: usize,
}

impl Threads {
    /// So many; 0 for as many as there are processors.
    #[must_use]
    pub fn asked(asked: usize) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        Self { asked, processors }
    }

    /// How many there are to be.
    #[must_use]
    pub fn number(self) -> usize {
        match self.asked {
            0 => self.processors,
            asked => asked.min(self.processors),
        }
    }

    /// What to tell who asked for more than that.
    #[must_use]
    pub fn warning(self) -> Option<String> {
        let Self { asked, processors } = self;
        (asked > processors).then(|| {
            format!("{asked} threads are more than there are processors: {processors} are used")
        })
    }
}

/// The threads that share the work of a computation, and the flag that stops it.
#[derive(Clone, Copy)]
pub(crate) struct Workers<'r> {
    /// Threads; none for the calling one alone.
    pub(crate) pool: Option<&'r rayon::ThreadPool>,
    /// Asks the computation to stop.
    pub(crate) cancel: &'r CancelToken,
}

impl<'r> Workers<'r> {
    /// The threads, if there are enough `tasks` for more than one.
    fn threads(self, tasks: usize) -> Option<&'r rayon::ThreadPool> {
        self.pool
            .filter(|pool| tasks > 1 && pool.current_num_threads() > 1)
    }

    /// `one` of every number below `count`, in their order. A thread takes at least `least` of them at a
    /// time, and makes itself a `work` to do them with.
    pub(crate) fn map<W, T: Send>(
        self,
        count: usize,
        least: usize,
        work: impl Fn() -> W + Sync + Send,
        one: impl Fn(&mut W, usize) -> T + Sync + Send,
    ) -> Vec<T> {
        match self.threads(count / least) {
            Some(pool) => pool.install(|| {
                let numbers = (0..count).into_par_iter().with_min_len(least);
                numbers.map_init(work, one).collect()
            }),
            None => {
                let mut work = work();
                (0..count).map(|number| one(&mut work, number)).collect()
            }
        }
    }

    /// Does `one` to every piece of `length` values, which it is told by number; threads as in
    /// [`Self::map`].
    pub(crate) fn fill<W, T: Send>(
        self,
        values: &mut [T],
        length: usize,
        least: usize,
        work: impl Fn() -> W + Sync + Send,
        one: impl Fn(&mut W, usize, &mut [T]) + Sync + Send,
    ) {
        match self.threads(values.len().div_ceil(length) / least) {
            Some(pool) => pool.install(|| {
                let pieces = values.par_chunks_mut(length).enumerate();
                pieces
                    .with_min_len(least)
                    .for_each_init(work, |work, (number, piece)| one(work, number, piece));
            }),
            None => {
                let mut work = work();
                for (number, piece) in values.chunks_mut(length).enumerate() {
                    one(&mut work, number, piece);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn threads_are_no_more_than_processors() {
        let of = |asked| Threads {
            asked,
            processors: 4,
        };
        assert_eq!(
            [0, 1, 4, 5, 9999].map(|asked| of(asked).number()),
            [4, 1, 4, 4, 4]
        );
        assert_eq!(
            [0, 1, 4].map(|asked| of(asked).warning()),
            [None, None, None]
        );
        let told = of(9999).warning().unwrap();
        assert_eq!(
            told,
            "9999 threads are more than there are processors: 4 are used"
        );
    }
}
