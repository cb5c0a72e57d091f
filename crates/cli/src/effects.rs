//! `bulge effects`: reference of the catalogue of physical effects and force laws.

use bulge_effects::law::{LAWS, PAPERS, reference};
use bulge_effects::{CardDocument, Catalogue, describe, overview};
use clap::Args;
use serde_json::json;
use std::path::PathBuf;

use crate::arguments;
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
    /// One JSON document on standard output
    #[arg(long)]
    json: bool,
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
        if !self.json {
            return Ok(reference());
        }
        let document = json!({"schema": "bulge.laws/1", "papers": PAPERS, "laws": LAWS});
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }

    fn one(&self, catalogue: &Catalogue, name: &str) -> Result<String, Failure> {
        if let Some(law) = bulge_effects::law::Law::find(name) {
            let document = json!({"schema": "bulge.law/1", "law": law});
            return if self.json {
                Ok(serde_json::to_string_pretty(&document)? + "\n")
            } else {
                Ok(law.to_string())
            };
        }
        let effect = catalogue.find(name)?;
        if !self.json {
            return Ok(describe(effect.as_ref()));
        }
        let document = json!({"schema": "bulge.effect/1", "effect": CardDocument::of(effect.as_ref())});
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }

    fn all(&self, catalogue: &Catalogue) -> Result<String, Failure> {
        if !self.json {
            return Ok(overview(catalogue));
        }
        let effects: Vec<_> = catalogue.iter().map(|effect| CardDocument::of(effect.as_ref())).collect();
        let document = json!({"schema": "bulge.effects/1", "effects": effects});
        Ok(serde_json::to_string_pretty(&document)? + "\n")
    }
}
