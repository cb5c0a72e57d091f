//! Messages to the page while it waits: server-sent events.

use axum::response::sse::{Event, KeepAlive, Sse};
use axum::response::{IntoResponse, Response};
use bulge_inference::Diagnosis;
use futures_util::stream::unfold;
use serde::Serialize;
use std::convert::Infallible;
use tokio::sync::watch;

use crate::diagnosis::{Listener, News};
use crate::refusal::Refusal;

/// An event with a document; it is empty if the document can't be serialised.
fn event(name: &str, document: &impl Serialize) -> Event {
    Event::default().event(name).data(serde_json::to_string(document).unwrap_or_default())
}

/// Reports a running diagnosis. `keep` receives the result before it is sent.
pub(crate) fn of_diagnosis(
    listener: Listener,
    keep: impl Fn(&Diagnosis) -> Result<(), Refusal> + Send + 'static,
) -> Response {
    type Keep = dyn Fn(&Diagnosis) -> Result<(), Refusal> + Send;
    let next = |(mut listener, keep): (Listener, Box<Keep>)| async move {
        let mut news = listener.news.recv().await?;
        if let News::Found(found) = &news
            && let Err(refusal) = keep(found)
        {
            news = News::Failed(refusal);
        }
        let told = match &news {
            News::Progress(stage) => event("progress", stage),
            News::Found(found) => event("result", found),
            News::Failed(refusal) => event("failed", refusal),
        };
        Some((Ok::<_, Infallible>(told), (listener, keep)))
    };
    let keep: Box<Keep> = Box::new(keep);
    Sse::new(unfold((listener, keep), next)).keep_alive(KeepAlive::default()).into_response()
}

/// Sends the number of changes whenever it grows.
pub(crate) fn of_revisions(seen: watch::Receiver<u64>) -> Response {
    #[derive(Serialize)]
    struct Revision {
        revision: u64,
    }
    let next = |mut seen: watch::Receiver<u64>| async move {
        seen.changed().await.ok()?;
        let revision = *seen.borrow_and_update();
        Some((Ok::<_, Infallible>(event("session", &Revision { revision })), seen))
    };
    Sse::new(unfold(seen, next)).keep_alive(KeepAlive::default()).into_response()
}
