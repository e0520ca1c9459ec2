//! Threads that share work, and the flag that cancels it.

use rayon::ThreadPool;
use std::num::NonZero;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Arc, Mutex, PoisonError};

/// A flag that cancels a running computation.
///
/// Clones share the flag. The solvers check it in every iteration.
#[derive(Debug, Clone, Default)]
pub struct CancelToken(Arc<AtomicBool>);

impl CancelToken {
    /// Requests cancellation.
    pub fn cancel(&self) {
        self.0.store(true, Ordering::Relaxed);
    }

    /// Whether cancellation was requested.
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.load(Ordering::Relaxed)
    }
}

/// The number of threads: as requested, but at most the number of processors. Further threads would only wait for each other, and starting
/// thousands of them takes long.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Threads {
    asked: usize,
    processors: usize,
}

impl Threads {
    /// Requests `asked` threads; 0 means as many as there are processors.
    #[must_use]
    pub fn asked(asked: usize) -> Self {
        let processors = std::thread::available_parallelism().map_or(1, NonZero::get);
        Self { asked, processors }
    }

    /// The number of threads to be used.
    #[must_use]
    pub fn number(self) -> usize {
        match self.asked {
            0 => self.processors,
            asked => asked.min(self.processors),
        }
    }

    /// The warning if more threads were requested than there are processors.
    #[must_use]
    pub fn warning(self) -> Option<String> {
        let Self { asked, processors } = self;
        (asked > processors).then(|| {
            format!("{asked} threads exceed the number of processors: {processors} are used")
        })
    }
}

/// The threads that share the work of a computation, and the flag that cancels it.
#[derive(Clone, Copy)]
pub(crate) struct Workers<'r> {
    /// Threads; `None` for the calling thread alone.
    pub(crate) pool: Option<&'r ThreadPool>,
    /// Cancels the computation.
    pub(crate) cancel: &'r CancelToken,
}

impl Workers<'_> {
    /// Returns the results of `one` for every number below `count`, in order. A thread processes at least `least` numbers at a time and
    /// creates one workspace with `work`.
    pub(crate) fn map<W, T: Send>(
        self,
        count: usize,
        least: usize,
        work: impl Fn() -> W + Sync,
        one: impl Fn(&mut W, usize) -> T + Sync,
    ) -> Vec<T> {
        map(self.pool, count, least, work, one)
    }

    /// Calls `one` with every piece of `length` values and the index of the piece; threads as in [`Self::map`].
    pub(crate) fn fill<W, T: Send>(
        self,
        values: &mut [T],
        length: usize,
        least: usize,
        work: impl Fn() -> W + Sync,
        one: impl Fn(&mut W, usize, &mut [T]) + Sync,
    ) {
        fill(self.pool, values, length, least, work, one);
    }
}

/// Average number of batches per thread: sufficient to balance batches of different duration.
const BATCHES_PER_THREAD: usize = 8;

/// [`Workers::map`] on the threads of a pool or on the calling thread.
pub(crate) fn map<W, T: Send>(
    pool: Option<&ThreadPool>,
    count: usize,
    least: usize,
    work: impl Fn() -> W + Sync,
    one: impl Fn(&mut W, usize) -> T + Sync,
) -> Vec<T> {
    let mut results: Vec<Option<T>> = (0..count).map(|_| None).collect();
    fill(
        pool,
        &mut results,
        1,
        least,
        work,
        |work, number, result| {
            result[0] = Some(one(work, number));
        },
    );
    results.into_iter().flatten().collect()
}

/// [`Workers::fill`] on the threads of a pool or on the calling thread.
pub(crate) fn fill<W, T: Send>(
    pool: Option<&ThreadPool>,
    values: &mut [T],
    length: usize,
    least: usize,
    work: impl Fn() -> W + Sync,
    one: impl Fn(&mut W, usize, &mut [T]) + Sync,
) {
    let pieces = values.len().div_ceil(length);
    let pool = pool.filter(|_| pieces / least > 1);
    let threads = pool.map_or(1, ThreadPool::current_num_threads);
    let batch = match threads {
        1 => pieces.max(1),
        threads => pieces.div_ceil(BATCHES_PER_THREAD * threads).max(least),
    };
    let batches = Mutex::new(values.chunks_mut(batch * length).enumerate());
    let next = || {
        let mut batches = batches.lock().unwrap_or_else(PoisonError::into_inner);
        batches.next()
    };
    share(pool, &|| {
        let mut workspace = None;
        while let Some((index, values)) = next() {
            let workspace = workspace.get_or_insert_with(&work);
            for (number, piece) in (index * batch..).zip(values.chunks_mut(length)) {
                one(workspace, number, piece);
            }
        }
    });
}

/// Calls `one` with every number below `count`, on the threads of a pool or on the calling thread.
pub(crate) fn for_each(pool: Option<&ThreadPool>, count: usize, one: &(dyn Fn(usize) + Sync)) {
    let next = AtomicUsize::new(0);
    share(pool.filter(|_| count > 1), &|| {
        loop {
            let number = next.fetch_add(1, Ordering::Relaxed);
            if number >= count {
                break;
            }
            one(number);
        }
    });
}

/// Runs `work` on every thread of a pool, or once on the calling thread. `work` returns when no work is left.
///
/// Not generic, so that the code for threads is compiled once instead of once for each loop, which took a fifth of the compilation time of
/// the crate.
#[inline(never)]
pub(crate) fn share(pool: Option<&ThreadPool>, work: &(dyn Fn() + Sync)) {
    match pool.filter(|pool| pool.current_num_threads() > 1) {
        Some(pool) => pool.scope(|scope| {
            for _ in 1..pool.current_num_threads() {
                scope.spawn(|_| work());
            }
            work();
        }),
        None => work(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_piece_is_visited_once_and_in_place() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(3)
            .build()
            .unwrap();
        for pool in [None, Some(&pool)] {
            for (count, least) in [(0, 1), (1, 1), (7, 3), (100, 1), (1000, 7)] {
                let squares = map(pool, count, least, || (), |(), number| number * number);
                assert!(
                    squares
                        .into_iter()
                        .eq((0..count).map(|number| number * number))
                );
                let mut values = vec![0; count];
                fill(
                    pool,
                    &mut values,
                    3,
                    least,
                    || (),
                    |(), number, piece| {
                        for value in piece {
                            *value += 10 * number + 1;
                        }
                    },
                );
                assert!(
                    values
                        .into_iter()
                        .eq((0..count).map(|place| 10 * (place / 3) + 1))
                );
                let visits: Vec<_> = (0..count).map(|_| AtomicUsize::new(0)).collect();
                for_each(pool, count, &|number| {
                    visits[number].fetch_add(1, Ordering::Relaxed);
                });
                assert!(visits.into_iter().all(|visits| visits.into_inner() == 1));
            }
        }
    }

    /// Nested loops on the same threads terminate, independent of which thread waits for which.
    #[test]
    fn loops_nest() {
        let pool = rayon::ThreadPoolBuilder::new()
            .num_threads(2)
            .build()
            .unwrap();
        let sums = map(
            Some(&pool),
            20,
            1,
            || (),
            |(), number| {
                let inner = map(Some(&pool), number, 1, || (), |(), inner| inner);
                inner.into_iter().sum::<usize>()
            },
        );
        assert!(
            sums.into_iter()
                .enumerate()
                .all(|(n, sum)| sum == n * n.saturating_sub(1) / 2)
        );
    }

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
        let message = of(9999).warning().unwrap();
        assert_eq!(
            message,
            "9999 threads exceed the number of processors: 4 are used"
        );
    }
}
