//! The requests of the page and their handlers.

use axum::Router;
use axum::body::{Body, Bytes, to_bytes};
use axum::extract::Request;
use axum::http::request::Parts;
use axum::http::{HeaderValue, Method, StatusCode, header};
use axum::response::{IntoResponse, Response};
use bulge_effects::Known;
use bulge_inference::Protocol;
use bulge_muscles::Muscle;
use bulge_muscles::output::Unfinished;
use futures_util::StreamExt;
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::HashMap;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use tokio::sync::watch;

use crate::ahead::Waiting;
use crate::answers;
use crate::assets::asset;
use crate::choices::ChosenEffect;
use crate::folder::file_name;
use crate::guard::Guard;
use crate::refusal::{Place, Refusal};
use crate::session::Session;
use crate::stream;
use crate::surface;
use crate::worker::Worker;

/// Most bytes of a file of measurements: the limit of the library.
const MOST_DATA: u64 = 2 << 30;
/// Most bytes of any other request: enough for a muscle's file, effects, a million excluded rows.
const MOST_REQUEST: usize = 16 << 20;

/// Content security policy: what pages of other sites may not do with ours, and what ours may not do at all.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; font-src 'self'; \
                      base-uri 'none'; form-action 'none'; frame-ancestors 'none'";
/// Policy of reports beyond their own: they may do nothing further.
const REPORT_POLICY: &str = "base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A muscle with its fitted effects.
pub(crate) type Shaped = Arc<(Muscle, Vec<Known>)>;

/// A running workbench.
pub(crate) struct Workbench {
    guard: Guard,
    session: Mutex<Session>,
    pub(crate) waiting: Waiting,
    pub(crate) quick: Worker,
    pub(crate) held_out: Worker,
    /// The muscle whose shape was requested last, with its revision.
    shaped: Mutex<Option<(u64, Shaped)>>,
    pub(crate) revision: watch::Sender<u64>,
}

impl Workbench {
    pub(crate) fn new(guard: Guard, session: Session) -> Self {
        let revision = watch::Sender::new(session.revision());
        let waiting = Waiting::default();
        Self {
            guard,
            session: Mutex::new(session),
            quick: Worker::quick(&waiting),
            held_out: Worker::held_out(&waiting),
            waiting,
            shaped: Mutex::default(),
            revision,
        }
    }

    /// Locks the session. A thread that panicked leaves it in a consistent state.
    pub(crate) fn session(&self) -> MutexGuard<'_, Session> {
        self.session.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// The muscle whose shape was requested last, if it belongs to this revision.
    pub(crate) fn shaped(&self, revision: u64) -> Option<Shaped> {
        let last = self.shaped.lock().unwrap_or_else(PoisonError::into_inner);
        last.as_ref().filter(|(of, _)| *of == revision).map(|(_, found)| Arc::clone(found))
    }

    pub(crate) fn keep_shaped(&self, revision: u64, found: &Shaped) {
        *self.shaped.lock().unwrap_or_else(PoisonError::into_inner) = Some((revision, Arc::clone(found)));
    }

    /// Applies a change, notifies all pages, and answers with the session.
    pub(crate) fn change(
        &self,
        make: impl FnOnce(&mut Session) -> Result<(), Refusal>,
    ) -> Result<Response, Refusal> {
        let mut session = self.session();
        make(&mut session)?;
        self.revision
            .send_if_modified(|known| std::mem::replace(known, session.revision()) != session.revision());
        json(&session.document())
    }
}

/// The routes: all of them pass the guard.
pub(crate) fn router(workbench: Arc<Workbench>) -> Router {
    Router::new().fallback(move |request: Request| {
        let workbench = Arc::clone(&workbench);
        async move { answer(workbench, request).await }
    })
}

async fn answer(workbench: Arc<Workbench>, request: Request) -> Response {
    let (parts, body) = request.into_parts();
    let asked = workbench.guard.admit(&parts.method, parts.uri.path(), &parts.headers).map(str::to_owned);
    let Some(asked) = asked else {
        let what =
            "this is not the address that `bulge open` printed: it ends in a word that only that run knows";
        return with_headers((StatusCode::FORBIDDEN, what).into_response());
    };
    let found = match asked.strip_prefix("api/") {
        Some(call) => api(workbench, call, &parts, body).await,
        None => page(&parts.method, &asked),
    };
    with_headers(found.unwrap_or_else(|refusal| refused(&refusal)))
}

/// A file of the page.
fn page(method: &Method, asked: &str) -> Result<Response, Refusal> {
    let name = if asked.is_empty() { "index.html" } else { asked };
    match asset(name).filter(|_| *method == Method::GET) {
        Some((kind, bytes)) => Ok(([(header::CONTENT_TYPE, kind)], bytes).into_response()),
        None => Err(missing(asked)),
    }
}

fn missing(asked: &str) -> Refusal {
    Refusal::new(Place::Request, format!("there is no `{asked}` here"))
}

async fn api(workbench: Arc<Workbench>, call: &str, parts: &Parts, body: Body) -> Result<Response, Refusal> {
    let asked = query(parts);
    match (parts.method.as_str(), call) {
        ("GET", "session") => blocking(workbench, |w| json(&w.session().document())).await,
        ("PUT", "session") => {
            let change = parsed(body).await?;
            blocking(workbench, |w| w.change(|session| session.change(change))).await
        }
        ("POST", "undo") => blocking(workbench, |w| w.change(Session::undo)).await,
        ("POST", "redo") => blocking(workbench, |w| w.change(Session::redo)).await,
        ("POST", "data") => receive(workbench, &asked, parts, body).await,
        ("GET", "comparison" | "comparison.json") => {
            let held_out = asked.get("held_out").is_none_or(|value| value != "0");
            json(&*answers::comparison(&workbench, held_out).await?)
        }
        ("POST", "prepare") => {
            let effects: Vec<ChosenEffect> = parsed(body).await?;
            json(&answers::prepare(&workbench, &effects).await?)
        }
        ("GET", "rows") => answers::rows(&workbench).await,
        ("GET", "rows.csv") => answers::rows_file(&workbench, "rows.csv").await,
        ("GET", "rows.parquet") => answers::rows_file(&workbench, "rows.parquet").await,
        ("GET", "effects") => json(&answers::effects(&workbench).await?),
        ("POST", "effects/check") => json(&answers::checked_effects(&text(body).await?)?),
        ("GET", "muscles") => json(&answers::muscles()),
        ("GET", "shape") => {
            let state = state(&asked)?;
            let learning = answers::learning(&workbench).await;
            blocking(workbench, move |w| json(&surface::surface(&answers::muscle(&w, learning)?, state)?))
                .await
        }
        ("GET", "shape.vtp") => {
            let state = state(&asked)?;
            let learning = answers::learning(&workbench).await;
            let bytes =
                blocking(workbench, move |w| surface::vtp(&answers::muscle(&w, learning)?, state)).await?;
            Ok(([(header::CONTENT_TYPE, "application/xml")], bytes).into_response())
        }
        ("GET", "learnt.toml") => {
            let fitting = answers::learnt(&workbench).await?;
            Ok(blocking(workbench, |_| answers::model(fitting)).await?.into_response())
        }
        ("GET", "report") => Ok(report(answers::report(&workbench).await?)),
        ("GET", "diagnosis-report") => {
            blocking(workbench, |w| w.session().diagnosis().map(|found| report(found.report))).await
        }
        ("GET", "diagnosis.json") => {
            blocking(workbench, |w| w.session().diagnosis().map(|found| as_json(found.document))).await
        }
        ("GET", "protocol") => blocking(workbench, |w| json(&answers::protocol(&w)?)).await,
        ("POST", "plan") => {
            let protocol: Protocol = parsed(body).await?;
            let learning = answers::learning(&workbench).await;
            let planned = move |w: Arc<Workbench>| {
                json(&answers::plan(&w, &answers::muscle(&w, learning)?, &protocol)?)
            };
            blocking(workbench, planned).await
        }
        ("POST", "diagnose") => {
            let about = workbench.session().choices().clone();
            let listener = blocking(Arc::clone(&workbench), |w| answers::diagnose(&w)).await?;
            Ok(stream::of_diagnosis(listener, move |found| {
                answers::keep_diagnosis(&workbench, found, &about)
            }))
        }
        ("GET", "events") => Ok(stream::of_revisions(workbench.revision.subscribe())),
        _ => Err(missing(&format!("api/{call}"))),
    }
}

/// Receives a file of measurements and writes it directly to the disk.
async fn receive(
    workbench: Arc<Workbench>,
    asked: &HashMap<String, String>,
    parts: &Parts,
    body: Body,
) -> Result<Response, Refusal> {
    let name = asked.get("name").map(String::as_str).and_then(file_name);
    let name =
        name.ok_or_else(|| Refusal::new(Place::Data, "the file has no name that can be kept: rename it"))?;
    let beside = asked.get("add").is_some_and(|value| value == "1");
    let too_large =
        || Refusal::new(Place::Data, format!("{name} is larger than 2 GiB: thin it, or split it"));
    let length =
        parts.headers.get(header::CONTENT_LENGTH).and_then(|value| value.to_str().ok()?.parse::<u64>().ok());
    if length.is_some_and(|length| length > MOST_DATA) {
        return Err(too_large());
    }
    let folder = workbench.session().folder.data();
    let failed = |error: std::io::Error| Refusal::new(Place::Data, format!("cannot keep {name}: {error}"));
    // An error, or a page that goes away, drops the file, and thereby removes it.
    let mut file = Unfinished::new(&folder, name.as_ref()).map_err(failed)?;
    let mut stream = body.into_data_stream();
    let mut bytes = 0;
    while let Some(part) = stream.next().await {
        let part =
            part.map_err(|error| Refusal::new(Place::Data, format!("{name} did not arrive whole: {error}")))?;
        bytes += part.len() as u64;
        if bytes > MOST_DATA {
            return Err(too_large());
        }
        // The system takes the bytes into its memory, which is faster than another thread that would.
        file.write(&part).map_err(failed)?;
    }
    blocking(workbench, move |w| {
        let placed = w.session().folder.place(&name, file);
        let path =
            placed.map_err(|error| Refusal::new(Place::Data, format!("cannot keep {name}: {error}")))?;
        w.change(|session| session.take(name, path, beside))
    })
    .await
}

/// Runs a computation that takes long or waits on another thread than the one that receives requests.
async fn blocking<T: Send + 'static>(
    workbench: Arc<Workbench>,
    compute: impl FnOnce(Arc<Workbench>) -> Result<T, Refusal> + Send + 'static,
) -> Result<T, Refusal> {
    let found = tokio::task::spawn_blocking(move || crate::worker::of_all(|| compute(workbench))).await;
    found.unwrap_or_else(|error| Err(Refusal::new(Place::Request, error)))
}

/// The pairs of the query string.
fn query(parts: &Parts) -> HashMap<String, String> {
    let text = parts.uri.query().unwrap_or_default();
    text.split('&')
        .filter_map(|pair| pair.split_once('='))
        .map(|(name, value)| (decoded(name), decoded(value)))
        .collect()
}

/// Text with its escapes (`%20`) decoded.
fn decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let Some((&first, after)) = rest.split_first() {
        let escaped = after.get(..2).and_then(|digits| std::str::from_utf8(digits).ok());
        let escaped = escaped.and_then(|digits| u8::from_str_radix(digits, 16).ok());
        if let Some(byte) = escaped.filter(|_| first == b'%') {
            bytes.push(byte);
            rest = &after[2..];
        } else {
            bytes.push(if first == b'+' { b' ' } else { first });
            rest = after;
        }
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

/// The state of which the shape is requested.
fn state(asked: &HashMap<String, String>) -> Result<surface::State, Refusal> {
    let number = |name: &str| {
        let value =
            asked.get(name).and_then(|text| text.parse::<f64>().ok()).filter(|value| value.is_finite());
        value.ok_or_else(|| Refusal::new(Place::Shape, format!("`{name}` must be a number")))
    };
    Ok(surface::State { pressure_pa: number("pressure_pa")?, contraction: number("contraction")? })
}

async fn bytes(body: Body) -> Result<Bytes, Refusal> {
    let found = to_bytes(body, MOST_REQUEST).await;
    found.map_err(|error| Refusal::new(Place::Request, format!("the request did not arrive whole: {error}")))
}

async fn text(body: Body) -> Result<String, Refusal> {
    String::from_utf8(bytes(body).await?.to_vec()).map_err(Refusal::at(Place::Request))
}

async fn parsed<T: DeserializeOwned>(body: Body) -> Result<T, Refusal> {
    serde_json::from_slice(&bytes(body).await?).map_err(Refusal::at(Place::Request))
}

fn json(document: &impl Serialize) -> Result<Response, Refusal> {
    Ok(as_json(serde_json::to_string(document).map_err(Refusal::at(Place::Request))?))
}

fn as_json(text: String) -> Response {
    ([(header::CONTENT_TYPE, "application/json")], text).into_response()
}

fn report(page: String) -> Response {
    let kind = "text/html; charset=utf-8";
    let policy = format!("{}; {REPORT_POLICY}", bulge_report::policy(true));
    ([(header::CONTENT_TYPE, kind), (header::CONTENT_SECURITY_POLICY, &policy)], page).into_response()
}

fn refused(refusal: &Refusal) -> Response {
    let text = serde_json::to_string(refusal).unwrap_or_default();
    (StatusCode::UNPROCESSABLE_ENTITY, as_json(text)).into_response()
}

/// Adds the headers of every answer.
fn with_headers(mut response: Response) -> Response {
    let headers = response.headers_mut();
    headers.entry(header::CONTENT_SECURITY_POLICY).or_insert(HeaderValue::from_static(POLICY));
    headers.insert(header::CACHE_CONTROL, HeaderValue::from_static("no-store"));
    headers.insert(header::X_CONTENT_TYPE_OPTIONS, HeaderValue::from_static("nosniff"));
    headers.insert(header::REFERRER_POLICY, HeaderValue::from_static("no-referrer"));
    headers.insert("cross-origin-resource-policy", HeaderValue::from_static("same-origin"));
    response
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn escapes_are_taken_out_once() {
        let found = ["a%20b", "a+b", "100%", "%e4", "%2525", "%zz", "%c3%a4"].map(decoded);
        assert_eq!(found, ["a b", "a b", "100%", "\u{fffd}", "%25", "%zz", "ä"]);
    }
}
