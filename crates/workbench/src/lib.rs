//! The workbench: a local page on which a model is compared with measurements by hand, live.
//!
//! [`serve`] listens on 127.0.0.1, prints nothing and opens nothing: whoever calls it is told the address. The page asks, and gets the documents that the
//! command line writes with `--json`: it holds no physics. What a person has chosen is a session in a folder, written at each change, so that a killed
//! process loses nothing; undo goes back through its steps.
//!
//! - `choices`, `session`, `folder`: what was chosen, how it came about, where it is kept,
//! - `inputs`, `worker`, `ahead`, `diagnosis`: rows, muscle and catalogue, and the threads that compute with them,
//! - `answers`, `surface`, `command`: the documents,
//! - `server`, `stream`, `guard`, `assets`: HTTP, and who may ask.
//!
//! Deliberately absent: physics, files of the user (it reads those that are named, and writes into its session's folder alone), any other address than this
//! machine's.

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

/// What a workbench begins with.
#[derive(Debug, Clone)]
pub struct Start {
    /// Measurements, muscle and effects.
    pub choices: Choices,
    /// Whether they were asked for: then a session that is there goes on with them, unless they are those that it was opened with before; else it goes on with its
    /// own.
    pub is_stated: bool,
    /// Port to listen on; 0: the one that the session had before, or any that is free.
    pub port: u16,
    /// Folder of the session; none: a temporary one.
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
        /// What the system says.
        source: std::io::Error,
    },
    /// What the folder holds can't be used.
    #[error("{0}")]
    Session(String),
    /// The port can't be had.
    #[error("cannot listen on port {port} of this machine: {source}; give another one with --port, or none")]
    Port {
        /// The port.
        port: u16,
        /// What the system says.
        source: std::io::Error,
    },
    /// The system has no random numbers.
    #[error("the system gives no random numbers: {0}")]
    Random(#[from] getrandom::Error),
    /// The system ended the server.
    #[error("the server ended: {0}")]
    Ended(std::io::Error),
}

/// Serves the page until Ctrl-C; `ready` is told the address once it can be opened.
///
/// # Errors
/// If the folder or the port can't be used.
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
        // Where none is stated, the port that it had before, so that a page that is open goes on.
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
    // Computations under way are of no use to anyone.
    runtime.shutdown_background();
    outcome
}

/// Ctrl-C, or the system's wish that the process ends.
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
