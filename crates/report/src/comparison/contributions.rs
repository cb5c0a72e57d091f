//! Contribution of each effect to the force: areas stacked on zero, against the misfit of the base.

use crate::PlotError;
use crate::axis::Axis;
use crate::comparison::legend::{self, Mark};
use crate::comparison::levels::{left_out, spread};
use crate::comparison::number::{bar, newton};
use crate::comparison::panel::{BELOW, Panel, columns};
use crate::comparison::svg::{Stroke, Svg, TEXT, fitted};
use crate::comparison::wording::effect_title;
use crate::comparison::{Plot, WIDTH};
use crate::palette::{CATEGORIES, INK, Rgb};
use bulge_inference::{Comparison, Stack};

/// Most pressure levels, drawn side by side.
const LEVELS: usize = 3;
const HEAD: f64 = 30.0;
const HEIGHT: f64 = 280.0;
/// The rest of the effects together.
const REST: Rgb = Rgb(200, 200, 200);

/// An effect, or the sum of the remaining ones, with its size over all levels.
struct Share {
    name: String,
    colour: Rgb,
    effects: Vec<String>,
}

/// The plot; `None` without effects.
///
/// # Errors
/// The range of the forces overflows.
pub(crate) fn plot(comparison: &Comparison) -> Result<Option<Plot>, PlotError> {
    let stacks: Vec<&Stack> = usable(comparison).collect();
    let shares = shares(&stacks);
    if shares.is_empty() {
        return Ok(None);
    }
    let chosen: Vec<&Stack> = spread(stacks.len(), LEVELS).into_iter().map(|i| stacks[i]).collect();
    let mut entries = vec![(Mark::Dot(INK), "measured − base: what is to be explained".to_owned())];
    entries.push((Mark::Line(Stroke::solid(INK, 1.5)), "sum of all effects".to_owned()));
    let title = |share: &Share| fitted(effect_title(comparison, &share.name), TEXT, 300.0);
    entries.extend(shares.iter().map(|share| (Mark::Box(share.colour), title(share))));
    let start = legend::height(&entries, WIDTH - 20.0) + 6.0;
    let mut svg = Svg::new("contributions", WIDTH, start + HEAD + HEIGHT + BELOW);
    legend::draw(&mut svg, (6.0, 2.0), WIDTH - 20.0, &entries);
    let y = upwards(&chosen, &shares)?;
    for (stack, (left, width)) in chosen.iter().zip(columns(chosen.len(), WIDTH)) {
        let across = chosen.iter().flat_map(|s| s.contraction.iter().map(|c| 100.0 * c));
        let x = Axis::few("contraction [%]", 5.0, across)?;
        let panel = Panel { x, y, left, top: start + HEAD, width, height: HEIGHT };
        panel.draw(&mut svg, &bar(stack.pressure_pa), "contraction [%]", "contribution [N]");
        draw(&mut svg, &panel, stack, &shares);
    }
    let left_out = left_out(chosen.len(), stacks.len(), "pressure levels");
    let (both, friction) = if comparison.data.is_path {
        let friction = " Friction adds as much on one branch as it takes on the other, so it is small here.";
        (", averaged over both directions", friction)
    } else {
        ("", "")
    };
    Ok(Some(Plot {
        name: "contributions",
        title: "What each effect contributes".to_owned(),
        caption: format!(
            "Dots show what the base misses{both}; coloured areas show what each effect adds (above zero) or takes away (below); the \
             line is their sum. Where the line runs through the dots, the effects explain what the base misses.{friction}{left_out}"
        ),
        svg: svg.finish("Contribution of each effect to the force"),
    }))
}

fn usable(comparison: &Comparison) -> impl Iterator<Item = &Stack> {
    comparison.contributions.iter().filter(|stack| !stack.contraction.is_empty() && !stack.parts.is_empty())
}

/// Mean size of an effect over all levels \[N\].
fn size(stacks: &[&Stack], effect: &str) -> f64 {
    let parts = stacks.iter().flat_map(|stack| &stack.parts).filter(|part| part.effect == effect);
    let (sum, count) =
        parts.flat_map(|part| &part.force_n).fold((0.0, 0.0), |(s, n), f| (s + f.abs(), n + 1.0));
    if count > 0.0 { sum / count } else { 0.0 }
}

/// Effects by size.
fn ranked(stacks: &[&Stack]) -> Vec<(String, f64)> {
    let mut names: Vec<String> = Vec::new();
    for part in stacks.iter().flat_map(|stack| &stack.parts) {
        if !names.contains(&part.effect) {
            names.push(part.effect.clone());
        }
    }
    let mut ranked: Vec<_> = names.into_iter().map(|name| (size(stacks, &name), name)).collect();
    ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
    ranked.into_iter().map(|(size, name)| (name, size)).collect()
}

/// The largest effects, as many as there are colours; the others are summed.
fn shares(stacks: &[&Stack]) -> Vec<Share> {
    let ranked = ranked(stacks);
    let own = if ranked.len() > CATEGORIES.len() { CATEGORIES.len() - 1 } else { ranked.len() };
    let mut shares: Vec<Share> = ranked[..own]
        .iter()
        .zip(CATEGORIES)
        .map(|((name, _), colour)| Share { name: name.clone(), colour, effects: vec![name.clone()] })
        .collect();
    if own < ranked.len() {
        let effects: Vec<String> = ranked[own..].iter().map(|(name, _)| name.clone()).collect();
        shares.push(Share { name: format!("{} smaller effects", effects.len()), colour: REST, effects });
    }
    shares
}

/// Force of a share along a stack.
fn forces(stack: &Stack, share: &Share) -> Vec<f64> {
    let mut sum = vec![0.0; stack.contraction.len()];
    for part in stack.parts.iter().filter(|part| share.effects.contains(&part.effect)) {
        sum.iter_mut().zip(&part.force_n).for_each(|(sum, force)| *sum += force);
    }
    sum
}

/// Lower and upper edge of each share: positive forces are stacked upward from zero, negative ones downward.
fn edges(stack: &Stack, shares: &[Share]) -> Vec<Vec<(f64, f64)>> {
    let mut piles = vec![(0.0, 0.0); stack.contraction.len()];
    shares
        .iter()
        .map(|share| {
            let forces = forces(stack, share);
            let with_piles = forces.iter().zip(&mut piles);
            with_piles
                .map(|(force, (below, above)): (&f64, &mut (f64, f64))| {
                    let pile = if *force < 0.0 { below } else { above };
                    let start = *pile;
                    *pile += force;
                    (start, *pile)
                })
                .collect()
        })
        .collect()
}

fn upwards(stacks: &[&Stack], shares: &[Share]) -> Result<Axis, PlotError> {
    let missed = stacks.iter().flat_map(|s| s.measured_n.iter().zip(&s.base_n).map(|(m, b)| m - b));
    let edges = stacks.iter().flat_map(|s| edges(s, shares)).flatten().flat_map(|(a, b)| [a, b]);
    let values: Vec<f64> = missed.chain(edges).chain([0.0]).collect();
    Axis::of("contribution [N]", values.iter().copied())
}

fn draw(svg: &mut Svg, panel: &Panel, stack: &Stack, shares: &[Share]) {
    let at = |i: usize, force: f64| panel.at((100.0 * stack.contraction[i], force));
    for (share, edges) in shares.iter().zip(edges(stack, shares)) {
        let there = edges.iter().enumerate().map(|(i, (_, end))| at(i, *end));
        let back = edges.iter().enumerate().rev().map(|(i, (start, _))| at(i, *start));
        let area: Vec<_> = there.chain(back).collect();
        svg.polygon(&area, share.colour);
    }
    let sums: Vec<f64> = shares
        .iter()
        .map(|share| forces(stack, share))
        .fold(vec![0.0; stack.contraction.len()], |sum, force| {
            sum.iter().zip(force).map(|(sum, force)| sum + force).collect()
        });
    let line: Vec<_> = sums.iter().enumerate().map(|(i, sum)| at(i, *sum)).collect();
    svg.polyline(&line, Stroke::solid(INK, 1.5));
    let missed = stack.measured_n.iter().zip(&stack.base_n).enumerate();
    let dots: Vec<_> = missed.map(|(i, (measured, base))| at(i, measured - base)).collect();
    svg.dots(&dots, 2.4, INK, 1.0);
}

/// The sentence above the plot.
pub(crate) fn says(comparison: &Comparison) -> String {
    let stacks: Vec<&Stack> = usable(comparison).collect();
    let ranked = ranked(&stacks);
    let Some((name, size)) = ranked.first() else {
        return "No effect was added: the base stands alone.".to_owned();
    };
    let others = match ranked.get(1) {
        Some((second, size)) => {
            format!("; next comes “{}” with {}", effect_title(comparison, second), newton(*size))
        }
        None => String::new(),
    };
    let name = effect_title(comparison, name);
    format!("“{name}” changes the force most, by {} on average over all levels{others}.", newton(*size))
}

#[cfg(test)]
mod tests {
    use super::*;
    use bulge_inference::Part;

    fn stack(parts: &[(&str, [f64; 2])]) -> Stack {
        Stack {
            pressure_pa: 1e5,
            contraction: vec![0.0, 0.1],
            measured_n: vec![10.0, 5.0],
            base_n: vec![8.0, 6.0],
            parts: parts
                .iter()
                .map(|(effect, force)| Part { effect: (*effect).to_owned(), force_n: force.to_vec() })
                .collect(),
        }
    }

    #[test]
    fn positive_parts_pile_up_and_negative_ones_down() {
        let stack = stack(&[("a", [3.0, -4.0]), ("b", [2.0, 1.0]), ("c", [-1.0, -1.0])]);
        let shares = shares(&[&stack]);
        let order: Vec<_> = shares.iter().map(|s| s.name.as_str()).collect();
        assert_eq!(order, ["a", "b", "c"]);
        let edges = edges(&stack, &shares);
        assert_eq!(edges[0], [(0.0, 3.0), (0.0, -4.0)]);
        assert_eq!(edges[1], [(3.0, 5.0), (0.0, 1.0)]);
        assert_eq!(edges[2], [(0.0, -1.0), (-4.0, -5.0)]);
    }

    #[test]
    fn many_effects_keep_their_sum() {
        let names: Vec<String> = (0..30).map(|i| format!("effect-{i}")).collect();
        let parts: Vec<_> = names.iter().map(|name| (name.as_str(), [1.0, 2.0])).collect();
        let stack = stack(&parts);
        let shares = shares(&[&stack]);
        assert_eq!(shares.len(), CATEGORIES.len());
        let sum: f64 = shares.iter().map(|share| forces(&stack, share)[1]).sum();
        assert!((sum - 60.0).abs() < 1e-9);
    }
}
