//! Whether the process of the editor still runs.

/// A process that the editor has named as its own.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ClientProcess(i32);

impl ClientProcess {
    /// Takes what `initialize` says; none where it names no process.
    pub fn new(params: &serde_json::Value) -> Option<Self> {
        let id = params.get("processId")?.as_i64()?;
        i32::try_from(id).ok().filter(|id| *id > 0).map(Self)
    }

    /// Tells whether it runs, as far as that can be found out.
    #[cfg(unix)]
    pub fn is_alive(self) -> bool {
        use rustix::io::Errno;
        use rustix::process::{Pid, test_kill_process};

        // A process of somebody else cannot be signalled, but it is there.
        Pid::from_raw(self.0).is_none_or(|id| test_kill_process(id) != Err(Errno::SRCH))
    }

    /// Tells whether it runs, as far as that can be found out.
    #[cfg(not(unix))]
    pub fn is_alive(self) -> bool {
        true
    }
}

impl std::fmt::Display for ClientProcess {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "process {}", self.0)
    }
}
