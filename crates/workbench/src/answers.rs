//! Requests of the page, answered by the library: the documents are those of the command line.

use axum::http::header;
use axum::response::{IntoResponse, Response};
use bulge_effects::{CardDocument, Catalogue, Effect, known};
use bulge_inference::{Comparison, Diagnosis, Fitting, Plan, Protocol};
use bulge_measurements::written;
use bulge_muscles::{PRESETS, Quantity, from_toml};
use bulge_report::{Learnt, rows};
use serde::Serialize;
use std::path::Path;
use std::sync::Arc;
use tokio::sync::oneshot;

use crate::choices::{Choices, ChosenEffect};
use crate::diagnosis::{self, Listener};
use crate::folder::Diagnosed;
use crate::inputs::{Inputs, MUSCLE, With, catalogue};
use crate::refusal::{Place, Refusal};
use crate::server::{Shaped, Workbench};
use crate::worker::{Question, Worker};

/// The inputs, choices and revision that a request is about.
struct Asked {
    revision: u64,
    inputs: Arc<Inputs>,
    with: With,
}

fn asked(workbench: &Workbench) -> Result<Asked, Refusal> {
    let session = workbench.session();
    let inputs = session.inputs()?;
    let with = inputs.with(&session.choices().effects)?;
    Ok(Asked { revision: session.revision(), inputs, with })
}

/// Sends a question to a worker and waits for the answer.
async fn ask<T>(
    worker: &Worker,
    asked: &Asked,
    with: With,
    question: impl FnOnce(oneshot::Sender<Result<T, Refusal>>) -> Question,
) -> Result<T, Refusal> {
    let (answer, waiting) = oneshot::channel();
    worker.ask(Arc::clone(&asked.inputs), with, question(answer));
    let gone = || Refusal::new(Place::Request, "the computation has ended: start `bulge open` again");
    waiting.await.unwrap_or_else(|_| Err(gone()))
}

/// The comparison with the chosen effects.
pub(crate) async fn comparison(workbench: &Workbench, held_out: bool) -> Result<Box<Comparison>, Refusal> {
    let asked = asked(workbench)?;
    let worker = if held_out { &workbench.held_out } else { &workbench.quick };
    ask(worker, &asked, asked.with.clone(), Question::Comparison).await
}

/// Prepares for these effects, which may be switched on next.
pub(crate) async fn prepare(workbench: &Workbench, effects: &[ChosenEffect]) -> Result<(), Refusal> {
    let asked = asked(workbench)?;
    let with = asked.inputs.with(effects)?;
    ask(&workbench.quick, &asked, with, Question::Prepared).await
}

/// All rows.
pub(crate) async fn rows(workbench: &Workbench) -> Result<Response, Refusal> {
    let asked = asked(workbench)?;
    let found = ask(&workbench.quick, &asked, asked.with.clone(), Question::Rows).await?;
    let bytes = rows::bytes(&found, asked.revision).map_err(Refusal::at(Place::Request))?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// The rows as a file that Bulge can read again; the extension of `name` gives its format.
pub(crate) async fn rows_file(workbench: &Workbench, name: &'static str) -> Result<Response, Refusal> {
    let asked = asked(workbench)?;
    let found = ask(&workbench.quick, &asked, asked.with.clone(), Question::Rows).await?;
    let bytes = written(Path::new(name), &found.columns()).map_err(Refusal::at(Place::Request))?;
    Ok(([(header::CONTENT_TYPE, "application/octet-stream")], bytes).into_response())
}

/// The report of the comparison, with errors on held-out data.
pub(crate) async fn report(workbench: &Workbench) -> Result<String, Refusal> {
    let asked = asked(workbench)?;
    let (comparison, rows) = ask(&workbench.held_out, &asked, asked.with.clone(), Question::Report).await?;
    bulge_report::comparison::html(&comparison, Some(&rows)).map_err(Refusal::at(Place::Request))
}

/// The catalogue for the page.
#[derive(Debug, Serialize)]
pub(crate) struct Effects {
    schema: &'static str,
    effects: Vec<Card>,
}

#[derive(Debug, Serialize)]
struct Card {
    #[serde(flatten)]
    card: CardDocument,
    /// Why it can't be added to this muscle with these data.
    unsuitable: Option<String>,
}

fn cards(catalogue: &Catalogue, unsuitable: Vec<Option<String>>) -> Effects {
    let cards = catalogue.iter().zip(unsuitable);
    let card = |(effect, unsuitable): (&Arc<dyn Effect>, _)| Card {
        card: CardDocument::of(effect.as_ref()),
        unsuitable,
    };
    Effects { schema: "bulge.effects/1", effects: cards.map(card).collect() }
}

/// All effects, with the reasons why some can't be added. Without data all of them can be viewed.
pub(crate) async fn effects(workbench: &Workbench) -> Result<Effects, Refusal> {
    let Ok(asked) = asked(workbench) else {
        let catalogue = catalogue(workbench.session().choices().own_effects.as_deref())?;
        let none = catalogue.iter().map(|_| None).collect();
        return Ok(cards(&catalogue, none));
    };
    let all =
        With { effects: asked.inputs.catalogue.iter().map(Arc::clone).collect(), restrictions: Vec::new() };
    let unsuitable = ask(&workbench.quick, &asked, all, Question::Unsuitable).await;
    // A muscle that can't be compared at all is reported where it is compared.
    let unsuitable = unsuitable.unwrap_or_else(|_| asked.inputs.catalogue.iter().map(|_| None).collect());
    Ok(cards(&asked.inputs.catalogue, unsuitable))
}

/// The user's own effects, if they can be read.
pub(crate) fn checked_effects(toml: &str) -> Result<Effects, Refusal> {
    let builtin = Catalogue::builtin().iter().count();
    let catalogue = catalogue(Some(toml))?;
    let own = catalogue
        .iter()
        .skip(builtin)
        .map(|effect| Card { card: CardDocument::of(effect.as_ref()), unsuitable: None });
    Ok(Effects { schema: "bulge.effects/1", effects: own.collect() })
}

/// The shipped muscles.
#[derive(Debug, Serialize)]
pub(crate) struct Muscles {
    muscles: Vec<Shipped>,
}

#[derive(Debug, Serialize)]
struct Shipped {
    name: &'static str,
    title: &'static str,
}

pub(crate) fn muscles() -> Muscles {
    let shipped = PRESETS.iter().map(|preset| Shipped { name: preset.name, title: preset.about });
    Muscles { muscles: shipped.collect() }
}

/// The fit of the muscle of one revision.
pub(crate) struct Learning {
    revision: u64,
    /// `None` if no effect is switched on, if the fit failed (the ladder says why), or if the muscle of this
    /// revision is already stored.
    fitting: Option<Box<Fitting>>,
}

/// The fit of the last rung of the ladder.
async fn fitting(workbench: &Workbench) -> Result<Learning, Refusal> {
    let asked = asked(workbench)?;
    if asked.with.effects.is_empty() {
        return Err(Refusal::new(Place::Effects, "nothing was learnt yet: switch an effect on"));
    }
    let found = ask(&workbench.quick, &asked, asked.with.clone(), Question::Fitting).await?;
    Ok(Learning { revision: asked.revision, fitting: Some(found) })
}

/// As [`fitting`], for use by [`muscle`]: a fit that failed is no error.
pub(crate) async fn learning(workbench: &Workbench) -> Learning {
    let revision = workbench.session().revision();
    if workbench.shaped(revision).is_some() {
        return Learning { revision, fitting: None };
    }
    fitting(workbench).await.unwrap_or(Learning { revision, fitting: None })
}

/// The muscle with the fitted effects; without a fit the muscle as given.
pub(crate) fn muscle(workbench: &Workbench, learning: Learning) -> Result<Shaped, Refusal> {
    if let Some(found) = workbench.shaped(learning.revision) {
        return Ok(found);
    }
    let (stated, own) = {
        let session = workbench.session();
        (session.choices().muscle.toml.clone(), session.choices().own_effects.clone())
    };
    let learnt = learning.fitting.and_then(|fitting| Learnt::of(*fitting).ok());
    let toml = learnt.map_or(stated, |learnt| learnt.model);
    let muscle = from_toml(&toml, MUSCLE).map_err(Refusal::at(Place::Muscle))?;
    let known = known(&muscle, &catalogue(own.as_deref())?).map_err(Refusal::at(Place::Muscle))?;
    let found = Arc::new((muscle, known));
    workbench.keep_shaped(learning.revision, &found);
    Ok(found)
}

/// The fit of the effects that are switched on.
pub(crate) async fn learnt(workbench: &Workbench) -> Result<Box<Fitting>, Refusal> {
    fitting(workbench).await?.fitting.ok_or_else(|| Refusal::new(Place::Effects, "nothing was learnt yet"))
}

/// The muscle with the fitted effects, as `bulge fit` writes it.
pub(crate) fn model(fitting: Box<Fitting>) -> Result<String, Refusal> {
    Ok(Learnt::of(*fitting).map_err(Refusal::at(Place::Effects))?.model)
}

/// A protocol that resembles the test from which the data come.
pub(crate) fn protocol(workbench: &Workbench) -> Result<Protocol, Refusal> {
    let inputs = workbench.session().inputs()?;
    Ok(Protocol::like(&inputs.data, inputs.muscle.length().si()))
}

/// A protocol as a file, and its expected result for the fitted muscle.
#[derive(Debug, Serialize)]
pub(crate) struct Planned {
    toml: String,
    plan: Plan,
}

/// The expected result of a protocol, before measuring.
pub(crate) fn plan(workbench: &Workbench, shaped: &Shaped, protocol: &Protocol) -> Result<Planned, Refusal> {
    let toml = protocol.to_toml();
    // The reader of files says what is wrong, and what to write instead.
    let protocol = Protocol::from_toml(&toml, "the protocol").map_err(Refusal::at(Place::Plan))?;
    let catalogue = catalogue(workbench.session().choices().own_effects.as_deref())?;
    let plan = bulge_inference::plan(&shaped.0, &shaped.1, &catalogue, &protocol);
    Ok(Planned { toml, plan: plan.map_err(Refusal::at(Place::Plan))? })
}

/// Begins a diagnosis.
pub(crate) fn diagnose(workbench: &Workbench) -> Result<Listener, Refusal> {
    let (inputs, options) = workbench.session().options(true)?;
    Ok(diagnosis::begin(inputs, options, workbench.waiting.begin()))
}

/// Stores a diagnosis with its report, and notifies all pages.
pub(crate) fn keep_diagnosis(
    workbench: &Workbench,
    found: &Diagnosis,
    about: &Choices,
) -> Result<(), Refusal> {
    let document = serde_json::to_string_pretty(found).map_err(Refusal::at(Place::Request))? + "\n";
    let report = bulge_report::diagnosis::html(found).map_err(Refusal::at(Place::Request))?;
    let found = Diagnosed { document, report };
    workbench.change(|session| session.diagnosed(&found, about.clone())).map(drop)
}
