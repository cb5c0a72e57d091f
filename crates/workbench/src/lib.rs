//! The workbench: a local page on which a user compares a model with measurements interactively.
//!
//! [`serve`] listens on 127.0.0.1; it prints nothing and opens nothing, and passes the address to its caller.
//! The page contains no physics: it requests the documents that the command line writes with `--json`. The
//! choices of a user form a session in a folder. It is written at each change, so a killed process loses
//! nothing, and undo goes back through its steps.
//!
//! - `choices`, `session`, `folder`: the choices, their history, and where they are stored,
//! - `inputs`, `worker`, `ahead`, `diagnosis`: rows, muscle and catalogue, and the threads that compute with
//!   them,
//! - `answers`, `surface`, `command`: the documents,
//! - `server`, `stream`, `guard`, `assets`: HTTP and access control.
//!
//! Deliberately absent: physics, changes to files of the user (it reads the files named and writes only into
//! the folder of its session), and any address other than this machine's.

mod ahead;
mod answers;
mod assets;
mod choices;
mod command;
mod diagnosis;
mod folder;
mod guard;
mod inputs;
mod refusal;
mod server;
mod session;
mod stream;
mod surface;
mod worker;

use std::net::Ipv4Addr;
use std::path::PathBuf;
use std::sync::Arc;
use thiserror::Error;
use tokio::net::TcpListener;

pub use choices::{Choices, ChosenEffect, DataFile, MuscleFile};

use folder::Folder;
use guard::{Guard, new_token};
use server::{Workbench, router};
use session::Session;

/// Initial state of a workbench.
#[derive(Debug, Clone)]
pub struct Start {
    /// Measurements, muscle and effects.
    pub choices: Choices,
    /// Whether the choices were given explicitly. If so, an existing session continues with them as a new
    /// step, unless it was last opened with the same ones. Otherwise it continues with its own choices.
    pub is_stated: bool,
    /// Port to listen on. 0: the previous port of the session, or any free one.
    pub port: u16,
    /// Folder of the session; `None`: a temporary one.
    pub session: Option<PathBuf>,
}

/// Why a workbench can't start, or had to end.
#[derive(Debug, Error)]
pub enum WorkbenchError {
    /// The folder of the session can't be used.
    #[error("cannot use {} as the folder of the session: {source}; give another one with --session", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The content of the folder can't be used.
    #[error("{0}")]
    Session(String),
    /// The port isn't available.
    #[error("cannot listen on port {port} of this machine: {source}; give another one with --port, or none")]
    Port {
        /// The port.
        port: u16,
        /// Error of the system.
        source: std::io::Error,
    },
    /// The system has no random numbers.
    #[error("the system gives no random numbers: {0}")]
    Random(#[from] getrandom::Error),
    /// The system ended the server.
    #[error("the server ended: {0}")]
    Ended(std::io::Error),
}

/// Serves the page until Ctrl-C. `ready` is called with the address once the page can be opened.
///
/// # Errors
/// The folder or the port can't be used.
pub fn serve(start: Start, ready: impl FnOnce(&str)) -> Result<(), WorkbenchError> {
    let path = start.session.clone().unwrap_or_else(std::env::temp_dir);
    let folder =
        Folder::open(start.session.as_deref()).map_err(|source| WorkbenchError::Folder { path, source })?;
    let mut session = Session::open(folder, start.choices, start.is_stated, new_token()?)
        .map_err(|refusal| WorkbenchError::Session(refusal.error))?;
    let runtime =
        tokio::runtime::Builder::new_current_thread().enable_all().build().map_err(WorkbenchError::Ended)?;
    let outcome = runtime.block_on(async {
        let of_port = |source| WorkbenchError::Port { port: start.port, source };
        let at = |port| TcpListener::bind((Ipv4Addr::LOCALHOST, port));
        // If no port is given, the previous one is used, so that an open page continues to work.
        let before =
            if start.port == 0 && session.port() != 0 { at(session.port()).await.ok() } else { None };
        let listener = match before {
            Some(listener) => listener,
            None => at(start.port).await.map_err(of_port)?,
        };
        let port = listener.local_addr().map_err(of_port)?.port();
        session.keep_port(port).map_err(|refusal| WorkbenchError::Session(refusal.error))?;
        let guard = Guard::new(port, session.token().to_owned());
        let address = guard.address();
        let served = axum::serve(listener, router(Arc::new(Workbench::new(guard, session))));
        ready(&address);
        tokio::select! {
            ended = async { served.await } => ended.map_err(WorkbenchError::Ended),
            () = asked_to_end() => Ok(()),
        }
    });
    // Nobody needs the computations that are still running.
    runtime.shutdown_background();
    outcome
}

/// Waits for Ctrl-C, or a request of the system to terminate.
async fn asked_to_end() {
    let interrupted = async { drop(tokio::signal::ctrl_c().await) };
    #[cfg(unix)]
    {
        use tokio::signal::unix::{SignalKind, signal};
        if let Ok(mut terminated) = signal(SignalKind::terminate()) {
            tokio::select! {
                () = interrupted => {}
                _ = terminated.recv() => {}
            }
            return;
        }
    }
    interrupted.await;
}
