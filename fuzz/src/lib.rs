//! What the targets share.

/// Lets the fuzzer's own thread do the work of the thread pool: a run is too short to be handed to another.
pub fn work_on_this_thread() {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).use_current_thread();
    pool.build_global().expect("no pool before this one");
}
