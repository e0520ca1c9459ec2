//! Limits the number of connections. Idle connections do not block others.
//!
//! A new connection is an *arrival* until it sends a request that the guard accepts. The number of
//! arrivals is limited: when it is exceeded, the oldest arrival is closed. A program that opens
//! connections without limit therefore closes only its own connections, and the page, which sends
//! its request immediately, receives a response.

use std::collections::VecDeque;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::sync::oneshot::{Receiver, Sender, channel};
use tokio::sync::{OwnedSemaphorePermit, Semaphore};

/// Largest number of simultaneous connections of the page.
const CONNECTIONS: usize = 128;

/// Largest number of simultaneous arrivals.
const ARRIVALS: usize = 64;

/// All connections.
#[derive(Debug, Clone)]
pub(crate) struct Connections {
    waiting: Arc<Mutex<Waiting>>,
    places: Arc<Semaphore>,
}

/// Arrivals in their order.
#[derive(Debug, Default)]
struct Waiting {
    next: u64,
    arrivals: VecDeque<(u64, Sender<()>)>,
}

/// A connection: an arrival, or one of the page.
#[derive(Debug, Clone)]
pub(crate) struct Connection {
    number: u64,
    connections: Connections,
    place: Arc<Mutex<Option<OwnedSemaphorePermit>>>,
}

impl Connections {
    pub(crate) fn new() -> Self {
        Self {
            waiting: Arc::default(),
            places: Arc::new(Semaphore::new(CONNECTIONS)),
        }
    }

    /// Adds an arrival; the second value signals when it must be closed in favour of another.
    pub(crate) fn arrive(&self) -> (Connection, Receiver<()>) {
        let (close, closed) = channel();
        let mut waiting = self.waiting.lock().unwrap_or_else(PoisonError::into_inner);
        if waiting.arrivals.len() >= ARRIVALS
            && let Some((_, oldest)) = waiting.arrivals.pop_front()
        {
            let _ = oldest.send(()); // it may have ended by itself
        }
        let number = waiting.next;
        waiting.next += 1;
        waiting.arrivals.push_back((number, close));
        drop(waiting);
        let connection = Connection {
            number,
            connections: self.clone(),
            place: Arc::default(),
        };
        (connection, closed)
    }
}

impl Connection {
    /// Keeps the connection after a request of the page. Returns false if there are too many connections already.
    pub(crate) fn stay(&self) -> bool {
        self.leave();
        let mut place = self.place.lock().unwrap_or_else(PoisonError::into_inner);
        if place.is_none() {
            *place = self.connections.places.clone().try_acquire_owned().ok();
        }
        place.is_some()
    }

    /// Removes the connection from the list of arrivals.
    pub(crate) fn leave(&self) {
        let waiting = self.connections.waiting.lock();
        let mut waiting = waiting.unwrap_or_else(PoisonError::into_inner);
        waiting
            .arrivals
            .retain(|(number, _)| *number != self.number);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_arrival_that_waited_longest_is_closed() {
        let connections = Connections::new();
        let mut arrived: Vec<_> = (0..ARRIVALS).map(|_| connections.arrive()).collect();
        assert!(arrived[0].0.stay());
        let last: Vec<_> = (0..2).map(|_| connections.arrive()).collect();
        let closed: Vec<bool> = arrived
            .iter_mut()
            .map(|(_, c)| c.try_recv().is_ok())
            .collect();
        // The first one belongs to the page now; one place was free, the other was that of the
        // second.
        assert!(
            closed
                .iter()
                .enumerate()
                .all(|(k, closed)| *closed == (k == 1)),
            "{closed:?}"
        );
        drop(last);
    }

    #[test]
    fn connections_of_the_page_are_counted_until_they_end() {
        let connections = Connections::new();
        let pages: Vec<_> = (0..CONNECTIONS).map(|_| connections.arrive().0).collect();
        assert!(pages.iter().all(Connection::stay));
        assert!(pages[0].stay(), "its own place is its own");
        let (more, _) = connections.arrive();
        assert!(!more.stay());
        drop(pages);
        assert!(more.stay());
    }
}
