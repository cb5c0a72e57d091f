//! What the page asks, answered by the library: the documents are those of the command line.

use axum::http::header;
use axum::response::{IntoResponse, Response};
use bulge_effects::{CardDocument, Catalogue, Effect, Known, known};
use bulge_inference::{Comparison, Diagnosis, Plan, Protocol, fit_effects};
use bulge_measurements::written;
use bulge_muscles::{Muscle, PRESETS, from_toml};
use bulge_report::{Learnt, rows};
use serde::Serialize;
use std::path::Path;
use std::sync::{Arc, PoisonError};
use tokio::sync::oneshot;

use crate::choices::{Choices, ChosenEffect};
use crate::diagnosis::{self, Listener};
use crate::folder::Diagnosed;
use crate::inputs::{Inputs, MUSCLE, With, catalogue};
use crate::refusal::{Place, Refusal};
use crate::server::Workbench;
use crate::surface::{self, State, Surface};
use crate::worker::{Question, Worker};

/// What is analysed, at one revision.
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

/// Asks a worker and waits.
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

/// Gets ready for these effects, which may be switched on next.
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

/// The same as a file that Bulge reads again; its name says of which kind.
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

/// All effects, with why some can't be added. Without data nothing keeps any from being looked at.
pub(crate) async fn effects(workbench: &Workbench) -> Result<Effects, Refusal> {
    let Ok(asked) = asked(workbench) else {
        let catalogue = catalogue(workbench.session().choices().own_effects.as_deref())?;
        let none = catalogue.iter().map(|_| None).collect();
        return Ok(cards(&catalogue, none));
    };
    let all =
        With { effects: asked.inputs.catalogue.iter().map(Arc::clone).collect(), restrictions: Vec::new() };
    let unsuitable = ask(&workbench.quick, &asked, all, Question::Unsuitable).await;
    // A muscle that can't be compared at all says so where it is compared.
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

/// The muscle as it was learnt, where effects are on and can be fitted; else as it is stated.
fn muscle(workbench: &Workbench) -> Result<Arc<(Muscle, Vec<Known>)>, Refusal> {
    let (revision, toml, own, has_effects) = {
        let session = workbench.session();
        let choices = session.choices();
        (
            session.revision(),
            choices.muscle.toml.clone(),
            choices.own_effects.clone(),
            !choices.effects.is_empty(),
        )
    };
    let mut last = workbench.shaped.lock().unwrap_or_else(PoisonError::into_inner);
    if let Some((_, found)) = last.as_ref().filter(|(of, _)| *of == revision) {
        return Ok(Arc::clone(found));
    }
    // What can't be learnt has a shape all the same: the ladder says why it can't.
    let toml = if has_effects { learnt(workbench).unwrap_or(toml) } else { toml };
    let muscle = from_toml(&toml, MUSCLE).map_err(Refusal::at(Place::Muscle))?;
    let known = known(&muscle, &catalogue(own.as_deref())?).map_err(Refusal::at(Place::Muscle))?;
    let found = Arc::new((muscle, known));
    *last = Some((revision, Arc::clone(&found)));
    Ok(found)
}

/// The bulge.
pub(crate) fn surface(workbench: &Workbench, state: State) -> Result<Surface, Refusal> {
    let found = muscle(workbench)?;
    surface::surface(&found.0, &found.1, state)
}

/// The bulge as a VTK file.
pub(crate) fn vtp(workbench: &Workbench, state: State) -> Result<Vec<u8>, Refusal> {
    let found = muscle(workbench)?;
    surface::vtp(&found.0, &found.1, state)
}

/// The muscle with what was learnt, as `bulge fit` writes it.
pub(crate) fn learnt(workbench: &Workbench) -> Result<String, Refusal> {
    let (inputs, options) = workbench.session().options(false)?;
    if options.effects.is_empty() {
        return Err(Refusal::new(Place::Effects, "nothing was learnt yet: switch an effect on"));
    }
    let fitting = fit_effects(&inputs.data, &inputs.muscle, &options).map_err(Refusal::at(Place::Effects))?;
    Ok(Learnt::of(fitting).map_err(Refusal::at(Place::Effects))?.model)
}

/// A protocol as a file, and what it would show of the muscle with what was learnt.
#[derive(Debug, Serialize)]
pub(crate) struct Planned {
    toml: String,
    plan: Plan,
}

/// Before measuring: what a protocol would show.
pub(crate) fn plan(workbench: &Workbench, protocol: &Protocol) -> Result<Planned, Refusal> {
    let toml = protocol.to_toml();
    // A file's reader says what is wrong, and what to write instead.
    let protocol = Protocol::from_toml(&toml, "the protocol").map_err(Refusal::at(Place::Plan))?;
    let found = muscle(workbench)?;
    let catalogue = catalogue(workbench.session().choices().own_effects.as_deref())?;
    let plan = bulge_inference::plan(&found.0, &found.1, &catalogue, &protocol);
    Ok(Planned { toml, plan: plan.map_err(Refusal::at(Place::Plan))? })
}

/// Begins a diagnosis.
pub(crate) fn diagnose(workbench: &Workbench) -> Result<Listener, Refusal> {
    let (inputs, options) = workbench.session().options(true)?;
    Ok(diagnosis::begin(inputs, options))
}

/// Keeps a diagnosis with its report, and tells all pages of it.
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
