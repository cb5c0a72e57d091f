//! `bulge effects`: reference of the catalogue of physical effects and force laws.

use bulge_effects::law::{LAWS, PAPERS, S1_VOLUME, reference};
use bulge_effects::{CardDocument, Catalogue, describe, overview};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

use crate::arguments::{self, Json};
use crate::failure::Failure;

/// The catalogue: equation, parameters, units, bounds, source, signature, what an effect is confused with.
#[derive(Debug, Args)]
pub(crate) struct EffectsCommand {
    /// Name of an effect or of a force law; without it, all effects in one line each
    name: Option<String>,
    /// Force laws of the papers instead of effects
    #[arg(long, conflicts_with = "name")]
    laws: bool,
    /// Your own effects, as expressions in a TOML file
    #[arg(long, value_name = "FILE")]
    effects: Option<PathBuf>,
    #[command(flatten)]
    json: Json,
}

impl EffectsCommand {
    pub(crate) fn run(&self) -> Result<String, Failure> {
        let catalogue = arguments::catalogue(self.effects.as_deref())?;
        match &self.name {
            _ if self.laws => self.laws(),
            Some(name) => self.one(&catalogue, name),
            None => self.all(&catalogue),
        }
    }

    fn laws(&self) -> Result<String, Failure> {
        let document = json!({"schema": "bulge.laws/1", "papers": PAPERS, "laws": LAWS});
        self.json.or(&document, reference)
    }

    fn one(&self, catalogue: &Catalogue, name: &str) -> Result<String, Failure> {
        if let Some(law) = bulge_effects::law::Law::find(name) {
            let document = json!({"schema": "bulge.law/1", "law": law});
            return self.json.or(&document, || law.to_string());
        }
        if name.eq_ignore_ascii_case(S1_VOLUME.name) {
            let document = json!({"schema": "bulge.volume-law/1", "law": S1_VOLUME});
            return self.json.or(&document, || S1_VOLUME.to_string());
        }
        let effect = catalogue.find(name)?;
        let document = json!({"schema": "bulge.effect/1", "effect": CardDocument::of(effect.as_ref())});
        self.json.or(&document, || describe(effect.as_ref()))
    }

    fn all(&self, catalogue: &Catalogue) -> Result<String, Failure> {
        let effects: Vec<_> = catalogue.iter().map(|effect| CardDocument::of(effect.as_ref())).collect();
        let document = json!({"schema": "bulge.effects/1", "effects": effects});
        self.json.or(&document, || overview(catalogue))
    }
}
