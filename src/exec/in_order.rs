//! Work done by all threads whose results are taken one at a time and in order.
//!
//! Each thread of the pool makes one item after the other. Whoever finishes the item that is next takes it, and those
//! behind it that are ready. Nobody runs ahead by more than a given number of items, so memory stays bounded; a thread
//! waits only while it holds no item, so the one that holds the oldest always goes on.

use std::collections::BTreeMap;
use std::sync::{Condvar, Mutex, MutexGuard, PoisonError};

/// Makes items `0..n_items` on all threads of the current rayon pool and takes each in order.
///
/// - `max_ahead`: how many items may be on their way at a time; at least 1.
/// - `make`: makes an item on any thread; the scratch memory is that of the thread, the item may have been another's
///   before. It must not wait for rayon, which could then call it a second time on the same thread.
/// - `take`: is called by any thread, never by two at a time, with the number of the item too.
///
/// # Errors
/// The first error of either; then no further item is begun.
pub(super) fn in_order<W, T, E>(
    n_items: u32,
    max_ahead: u32,
    make: impl Fn(&mut W, u32, &mut T) -> Result<(), E> + Sync,
    take: impl FnMut(u32, &mut T) -> Result<(), E> + Send,
) -> Result<(), E>
where
    W: Default,
    T: Default + Send,
    E: Send,
{
    let state = State {
        n_waiting: 0,
        n_begun: 0,
        n_taken: 0,
        ready: BTreeMap::new(),
        free: Vec::new(),
        take: Some(take),
        is_stopped: false,
        error: None,
    };
    let line = Line { n_items, max_ahead: max_ahead.max(1), make, state: Mutex::new(state), changed: Condvar::new() };
    let n_threads = rayon::current_num_threads().min(n_items as usize);
    rayon::scope(|scope| {
        for _ in 1..n_threads {
            scope.spawn(|_| line.work());
        }
        line.work();
    });
    let state = line.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    state.error.map_or(Ok(()), Err)
}

/// What the threads share.
struct Line<M, T, K, E> {
    n_items: u32,
    max_ahead: u32,
    make: M,
    state: Mutex<State<T, K, E>>,
    /// An item was taken, or the work has stopped.
    changed: Condvar,
}

struct State<T, K, E> {
    /// Threads that wait for `changed`: without any nobody is woken, which is a call to the system each time.
    n_waiting: u32,
    n_begun: u32,
    n_taken: u32,
    /// Items made that are not taken yet.
    ready: BTreeMap<u32, T>,
    /// Items taken, whose memory can be used again.
    free: Vec<T>,
    /// Absent while a thread is taking an item.
    take: Option<K>,
    is_stopped: bool,
    error: Option<E>,
}

impl<M, T, K, E> Line<M, T, K, E>
where
    T: Default,
    K: FnMut(u32, &mut T) -> Result<(), E>,
{
    /// Makes items until there are no more.
    fn work<W: Default>(&self)
    where
        M: Fn(&mut W, u32, &mut T) -> Result<(), E>,
    {
        let _guard = OnPanic(|| self.stop(self.lock(), None));
        let mut scratch = W::default();
        while let Some((idx, mut item)) = self.begin() {
            match (self.make)(&mut scratch, idx, &mut item) {
                Ok(()) => self.hand_over(idx, item),
                Err(error) => self.stop(self.lock(), Some(error)),
            }
        }
    }

    /// Waits until the next item may be begun; `None` when there is none to begin.
    fn begin(&self) -> Option<(u32, T)> {
        let may_not_begin = |state: &mut State<T, K, E>| {
            !state.is_stopped && state.n_begun < self.n_items && state.n_begun - state.n_taken >= self.max_ahead
        };
        let mut state = self.lock();
        if may_not_begin(&mut state) {
            state.n_waiting += 1;
            state = self.changed.wait_while(state, may_not_begin).unwrap_or_else(PoisonError::into_inner);
            state.n_waiting -= 1;
        }
        if state.is_stopped || state.n_begun == self.n_items {
            return None;
        }
        state.n_begun += 1;
        Some((state.n_begun - 1, state.free.pop().unwrap_or_default()))
    }

    /// Takes all items that are next, unless another thread is about it: that one will see this item too.
    fn hand_over(&self, idx: u32, item: T) {
        let mut state = self.lock();
        state.ready.insert(idx, item);
        while !state.is_stopped
            && let Some(mut take) = state.take.take()
        {
            let next = state.n_taken;
            let Some(mut item) = state.ready.remove(&next) else {
                state.take = Some(take);
                return;
            };
            drop(state);
            let taken = take(next, &mut item);
            state = self.lock();
            state.take = Some(take);
            state.free.push(item);
            state.n_taken += 1;
            match taken {
                Ok(()) if state.n_waiting > 0 => self.changed.notify_all(),
                Ok(()) => {}
                Err(error) => return self.stop(state, Some(error)),
            }
        }
    }

    /// Lets no further item be begun.
    fn stop(&self, mut state: MutexGuard<'_, State<T, K, E>>, error: Option<E>) {
        state.is_stopped = true;
        state.error = state.error.take().or(error);
        drop(state);
        self.changed.notify_all();
    }

    fn lock(&self) -> MutexGuard<'_, State<T, K, E>> {
        self.state.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Calls a function when a panic passes by: the other threads must not wait for an item that will never be made.
struct OnPanic<F: Fn()>(F);

impl<F: Fn()> Drop for OnPanic<F> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            (self.0)();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::panic::AssertUnwindSafe;
    use std::sync::atomic::{AtomicU32, Ordering};

    use super::*;

    fn in_pool<T: Send>(n_threads: usize, work: impl FnOnce() -> T + Send) -> T {
        rayon::ThreadPoolBuilder::new().num_threads(n_threads).build().expect("threads").install(work)
    }

    /// Takes longer for some items than for others.
    fn square(_: &mut (), idx: u32, item: &mut u32) -> Result<(), u32> {
        (0..idx * 7919 % 31).for_each(|_| std::thread::yield_now());
        *item = idx * idx;
        Ok(())
    }

    #[test]
    fn items_are_taken_in_order() {
        for (n_threads, n_items, max_ahead) in
            [(1, 5, 1), (1, 100, 7), (2, 100, 1), (5, 1000, 9), (8, 3, 100), (3, 0, 1)]
        {
            let mut taken = Vec::new();
            let ended: Result<(), u32> = in_pool(n_threads, || {
                in_order(n_items, max_ahead, square, |_, item| {
                    taken.push(*item);
                    Ok(())
                })
            });
            assert_eq!(ended, Ok(()));
            assert_eq!(taken, (0..n_items).map(|idx| idx * idx).collect::<Vec<_>>());
        }
    }

    #[test]
    fn nobody_runs_ahead() {
        let n_taken = AtomicU32::new(0);
        let make = |(): &mut (), idx: u32, _: &mut u32| {
            let ahead = idx - n_taken.load(Ordering::SeqCst);
            // An item may be counted after it is taken.
            if ahead <= 4 { Ok(()) } else { Err(ahead) }
        };
        let take = |_, _: &mut u32| {
            n_taken.fetch_add(1, Ordering::SeqCst);
            Ok(())
        };
        assert_eq!(in_pool(4, || in_order(2000, 4, make, take)), Ok(()));
    }

    #[test]
    fn memory_is_used_again() {
        let n_new = AtomicU32::new(0);
        let make = |_: &mut (), _: u32, item: &mut Vec<u8>| {
            if item.capacity() == 0 {
                n_new.fetch_add(1, Ordering::SeqCst);
                item.reserve(1);
            }
            Ok::<(), ()>(())
        };
        in_pool(3, || in_order(500, 5, make, |_, _| Ok(()))).expect("no errors");
        assert!(n_new.into_inner() <= 5);
    }

    #[test]
    fn an_error_ends_the_work() {
        for n_threads in [1, 4] {
            let make = |_: &mut (), idx: u32, item: &mut u32| {
                *item = idx;
                if idx == 50 { Err(idx) } else { Ok(()) }
            };
            assert_eq!(in_pool(n_threads, || in_order(1 << 30, 8, make, |_, _| Ok(()))), Err(50));
            let make = |_: &mut (), idx: u32, item: &mut u32| {
                *item = idx;
                Ok(())
            };
            let take = |_, item: &mut u32| if *item == 50 { Err(*item) } else { Ok(()) };
            assert_eq!(in_pool(n_threads, || in_order(1 << 30, 8, make, take)), Err(50));
        }
    }

    #[test]
    fn a_panic_reaches_the_caller() {
        for n_threads in [1, 4] {
            let make = |_: &mut (), idx: u32, _: &mut u32| {
                assert!(idx != 50, "as it is meant");
                Ok::<(), ()>(())
            };
            let work = || in_pool(n_threads, || in_order(1 << 30, 8, make, |_, _| Ok(())));
            assert!(std::panic::catch_unwind(AssertUnwindSafe(work)).is_err());
        }
    }
}
