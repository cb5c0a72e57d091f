//! A session: the choices, their history, and the inputs derived from them.

use bulge_inference::Options;
use bulge_measurements::Reading;
use bulge_muscles::{PRESETS, from_toml};
use serde::Serialize;
use serde_json::Value;
use std::collections::HashSet;
use std::path::PathBuf;
use std::sync::Arc;

use crate::choices::{Change, Choices, ChosenEffect, DataFile, MuscleChange, MuscleFile};
use crate::command;
use crate::folder::{Diagnosed, Folder, Kept, MOST_STEPS};
use crate::inputs::{Inputs, MUSCLE, catalogue, restrictions};
use crate::refusal::{Place, Refusal};

/// Most bytes of the page's own state.
const MOST_VIEW: usize = 64 << 10;

/// The state of a session that the page shows.
#[derive(Debug, Serialize)]
pub(crate) struct SessionDocument {
    schema: &'static str,
    revision: u64,
    can_undo: bool,
    can_redo: bool,
    data: DataDocument,
    columns: Option<String>,
    reading: Reading,
    muscle: MuscleDocument,
    effects: Vec<ChosenEffect>,
    own_effects: Option<String>,
    excluded: Vec<usize>,
    /// Why nothing can be computed with these choices.
    problem: Option<Refusal>,
    /// The diagnosis that can be saved.
    diagnosis: Option<DiagnosisDocument>,
    view: Value,
    command: String,
    python: String,
}

#[derive(Debug, Serialize)]
struct DataDocument {
    names: Vec<String>,
    rows: usize,
    /// Checksum of the data read; empty if none could be read.
    sha256: String,
}

#[derive(Debug, Serialize)]
struct DiagnosisDocument {
    /// Effects of the model.
    effects: Vec<ChosenEffect>,
    /// Whether data and muscle are still those of the diagnosis.
    is_current: bool,
}

#[derive(Debug, Serialize)]
struct MuscleDocument {
    name: String,
    toml: String,
    shipped: Option<String>,
}

/// A session.
#[derive(Debug)]
pub(crate) struct Session {
    pub(crate) folder: Folder,
    kept: Kept,
    revision: u64,
    inputs: Result<Arc<Inputs>, Refusal>,
}

impl Session {
    /// Continues with the state in the folder, or begins with these choices.
    pub(crate) fn open(
        folder: Folder,
        begin: Choices,
        is_stated: bool,
        token: String,
    ) -> Result<Self, Refusal> {
        let kept = match folder.kept()? {
            // Other choices given on the command line are a further step of an existing session.
            Some(mut kept) if is_stated && kept.stated.as_ref() != Some(&begin) => {
                kept.stated = Some(begin.clone());
                kept.past.push(std::mem::replace(&mut kept.choices, begin));
                kept
            }
            Some(kept) => kept,
            None => Kept::new(begin, token),
        };
        let inputs = Inputs::read(&kept.choices, None).map(Arc::new);
        let session = Self { folder, kept, revision: 1, inputs };
        session.folder.keep(&session.kept)?;
        Ok(session)
    }

    /// The random token at the end of the address.
    pub(crate) fn token(&self) -> &str {
        &self.kept.token
    }

    /// The port of the last run; 0: none.
    pub(crate) fn port(&self) -> u16 {
        self.kept.port
    }

    /// Stores the port of this run.
    pub(crate) fn keep_port(&mut self, port: u16) -> Result<(), Refusal> {
        self.kept.port = port;
        self.folder.keep(&self.kept)
    }

    pub(crate) fn revision(&self) -> u64 {
        self.revision
    }

    pub(crate) fn choices(&self) -> &Choices {
        &self.kept.choices
    }

    /// The inputs of an analysis.
    pub(crate) fn inputs(&self) -> Result<Arc<Inputs>, Refusal> {
        self.inputs.clone()
    }

    /// Applies a change, or returns an error and changes nothing.
    pub(crate) fn change(&mut self, change: Change) -> Result<(), Refusal> {
        let mut next = self.kept.choices.clone();
        change.columns.put(&mut next.columns);
        if let Some(columns) = &next.columns {
            columns.parse::<bulge_measurements::ColumnMap>().map_err(Refusal::at(Place::Columns))?;
        }
        if let Some(muscle) = change.muscle {
            next.muscle = other_muscle(muscle)?;
        }
        change.own_effects.put(&mut next.own_effects);
        if let Some(effects) = change.effects {
            next.effects = effects;
        }
        Self::check_effects(&next)?;
        if let Some(excluded) = change.excluded {
            next.excluded = self.exclude(excluded)?;
        }
        if change.view.as_ref().is_some_and(|view| view.to_string().len() > MOST_VIEW) {
            let what = format!("a view of more than {MOST_VIEW} bytes is not kept");
            return Err(Refusal::new(Place::Request, what));
        }
        self.keep(|own| {
            if let Some(view) = change.view {
                own.kept.view = view;
            }
            if change.goes_on && next != own.kept.choices && !own.kept.past.is_empty() {
                drop(own.go_to(next));
            } else {
                own.step(next);
            }
        })
    }

    /// Takes a file of measurements: it replaces the present ones, or is added to them if `beside`.
    pub(crate) fn take(&mut self, name: String, path: PathBuf, beside: bool) -> Result<(), Refusal> {
        let mut next = self.kept.choices.clone();
        // Two files of one analysis need two names.
        let is_taken = beside && next.data.iter().any(|file| file.name == name);
        let own = path.file_name().map(|name| name.to_string_lossy().into_owned()).filter(|_| is_taken);
        let file = DataFile { name: own.unwrap_or(name), path };
        if beside {
            next.data.push(file);
        } else {
            // The assignment of columns and the excluded rows belong to the old files.
            (next.data, next.columns) = (vec![file], None);
        }
        next.excluded = Vec::new();
        self.keep(|own| own.step(next))
    }

    /// Goes back one step.
    pub(crate) fn undo(&mut self) -> Result<(), Refusal> {
        self.keep(|own| {
            if let Some(before) = own.kept.past.pop() {
                let now = own.go_to(before);
                own.kept.future.push(now);
            }
        })
    }

    /// Goes forward one step.
    pub(crate) fn redo(&mut self) -> Result<(), Refusal> {
        self.keep(|own| {
            if let Some(after) = own.kept.future.pop() {
                let now = own.go_to(after);
                own.kept.past.push(now);
            }
        })
    }

    /// Makes a change and writes the state. If it can't be written, nothing is changed.
    fn keep(&mut self, make: impl FnOnce(&mut Self)) -> Result<(), Refusal> {
        let before = (self.kept.clone(), self.inputs.clone(), self.revision);
        make(self);
        let written = self.folder.keep(&self.kept);
        if written.is_err() {
            (self.kept, self.inputs, self.revision) = before;
        }
        written
    }

    /// Adds a step; steps that were undone are discarded.
    fn step(&mut self, next: Choices) {
        if next != self.kept.choices {
            let before = self.go_to(next);
            self.kept.past.push(before);
            self.kept.future.clear();
            let surplus = self.kept.past.len().saturating_sub(MOST_STEPS);
            self.kept.past.drain(..surplus);
        }
    }

    /// Replaces the choices and returns the previous ones.
    fn go_to(&mut self, next: Choices) -> Choices {
        let now = &self.kept.choices;
        if next.needs_other_inputs(now) {
            let rows = self.inputs.as_ref().ok().filter(|_| !next.needs_other_data(now));
            let rows = rows.map(|inputs| Arc::clone(&inputs.data));
            self.inputs = Inputs::read(&next, rows).map(Arc::new);
        }
        self.revision += 1;
        std::mem::replace(&mut self.kept.choices, next)
    }

    /// Rejects effects that are unknown or occur twice, and parameters that can't be fixed.
    fn check_effects(next: &Choices) -> Result<(), Refusal> {
        let catalogue = catalogue(next.own_effects.as_deref())?;
        let mut seen = HashSet::new();
        for ChosenEffect { name, .. } in &next.effects {
            catalogue.find(name).map_err(Refusal::at(Place::Effects))?;
            if !seen.insert(name) {
                return Err(Refusal::new(
                    Place::Effects,
                    format!("`{name}` is there already: each effect acts once"),
                ));
            }
        }
        // The bounds of values depend on the muscle. A muscle that can't be read is reported elsewhere.
        match from_toml(&next.muscle.toml, MUSCLE) {
            Ok(muscle) => restrictions(&next.effects, &catalogue, &muscle).map(drop),
            Err(_) => Ok(()),
        }
    }

    /// Rows to exclude, sorted; it is an error to exclude all rows.
    fn exclude(&self, mut rows: Vec<usize>) -> Result<Vec<usize>, Refusal> {
        rows.sort_unstable();
        rows.dedup();
        let count = self.inputs.as_ref().map_or(usize::MAX, |inputs| inputs.data.len());
        if let Some(beyond) = rows.iter().find(|row| **row >= count) {
            return Err(Refusal::new(
                Place::Excluded,
                format!("there is no row {beyond}: the data have {count}"),
            ));
        }
        if rows.len() >= count {
            return Err(Refusal::new(
                Place::Excluded,
                "all rows would be excluded: leave some to compare with",
            ));
        }
        Ok(rows)
    }

    /// The state that the page shows.
    pub(crate) fn document(&self) -> SessionDocument {
        let Kept { choices, past, future, view, diagnosed, .. } = &self.kept;
        let problem = self.inputs.as_ref().err();
        let (reading, rows, sha256) = match &self.inputs {
            Ok(inputs) => (inputs.data.reading().clone(), inputs.data.len(), inputs.data.sha256()),
            Err(refusal) => {
                (Reading { columns: refusal.columns.clone(), ..Reading::default() }, 0, String::new())
            }
        };
        let origin = choices.muscle.origin.clone();
        SessionDocument {
            schema: "bulge.session/1",
            revision: self.revision,
            can_undo: !past.is_empty(),
            can_redo: !future.is_empty(),
            data: DataDocument {
                names: choices.data.iter().map(|file| file.name.clone()).collect(),
                rows,
                sha256,
            },
            columns: choices.columns.clone(),
            reading,
            muscle: MuscleDocument {
                name: from_toml(&choices.muscle.toml, "")
                    .map_or_else(|_| String::new(), |muscle| muscle.name().to_owned()),
                toml: choices.muscle.toml.clone(),
                shipped: origin.filter(|name| PRESETS.iter().any(|preset| preset.name == name)),
            },
            effects: choices.effects.clone(),
            own_effects: choices.own_effects.clone(),
            excluded: choices.excluded.clone(),
            problem: problem.cloned(),
            diagnosis: diagnosed.as_ref().map(|about| DiagnosisDocument {
                effects: about.effects.clone(),
                is_current: !choices.needs_other_rows(about),
            }),
            view: view.clone(),
            command: command::shell(choices, self.inputs.as_ref().ok()),
            python: command::python(choices, self.inputs.as_ref().ok()),
        }
    }

    /// Stores a diagnosis of some choices.
    pub(crate) fn diagnosed(&mut self, found: &Diagnosed, about: Choices) -> Result<(), Refusal> {
        self.folder.keep_diagnosis(found).map_err(Refusal::at(Place::Request))?;
        self.keep(|own| {
            own.kept.diagnosed = Some(about);
            own.revision += 1;
        })
    }

    /// The last diagnosis.
    pub(crate) fn diagnosis(&self) -> Result<Diagnosed, Refusal> {
        if self.kept.diagnosed.is_none() {
            return Err(Refusal::new(Place::Request, "nothing was diagnosed yet: press Diagnose"));
        }
        self.folder.diagnosis().map_err(Refusal::at(Place::Request))
    }

    /// The inputs and options of a comparison with the chosen effects.
    pub(crate) fn options(&self, held_out: bool) -> Result<(Arc<Inputs>, Options), Refusal> {
        let inputs = self.inputs()?;
        let with = inputs.with(&self.kept.choices.effects)?;
        let options = inputs.options(with, held_out);
        Ok((inputs, options))
    }
}

/// The muscle named in a change.
fn other_muscle(change: MuscleChange) -> Result<MuscleFile, Refusal> {
    match change {
        MuscleChange::Shipped { shipped } => {
            let found = PRESETS.iter().find(|preset| preset.name == shipped);
            let found = found.ok_or_else(|| {
                Refusal::new(
                    Place::Muscle,
                    format!("no shipped muscle is called `{shipped}`: choose one of the list"),
                )
            })?;
            Ok(MuscleFile { toml: found.text.to_owned(), origin: Some(shipped) })
        }
        MuscleChange::Toml { toml } => {
            from_toml(&toml, MUSCLE).map_err(Refusal::at(Place::Muscle))?;
            Ok(MuscleFile { toml, origin: None })
        }
    }
}
