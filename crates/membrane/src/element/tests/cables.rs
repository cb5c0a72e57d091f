//! Cables: their energy, and the tension at a known strain.

use super::*;

/// A cable at this overall stretch, straight or bent.
fn cable<const N: usize>(reference: &[Vector; N], stretch: f64, bend: f64) -> [Vector; N] {
    shaken(reference, bend).map(|x| add(rotated(scaled(x, stretch), 1.1), [0.3, 0.2, -0.5]))
}

const STRAIGHT: [Vector; 3] = [[0.2, 0.1, 0.3], [1.0, 0.5, -0.4], [0.6, 0.3, -0.05]];
const BENT: [Vector; 3] = [[0.2, 0.1, 0.3], [1.0, 0.5, -0.4], [0.55, 0.42, 0.0]];

fn cables_of<const N: usize>(reference: &[Vector; N]) {
    for thread in [Thread::Elastic { stiffness: 25.0 }, Thread::Inextensible] {
        let fresh = Cable::new(reference, thread, 0.5).unwrap();
        let mut held = fresh.clone();
        // T0 = 40 x 0.03, and less if it is taken at a bent position.
        held.hold(&cable(reference, 1.03, 0.0), PENALTY);
        let mut uneven = fresh.clone();
        uneven.hold(&cable(reference, 1.05, 0.02), PENALTY);
        for (name, element) in [("fresh", &fresh), ("held", &held), ("uneven", &uneven)] {
            for stretch in [1.2, 1.001, 0.999, 0.971, 0.969, 0.8] {
                for bend in [0.0, 0.03] {
                    // Bent cables may straddle the border; only the overall stretches keep away from it.
                    let x = cable(reference, stretch, if (stretch - 1.0).abs() < 0.1 { 0.0 } else { bend });
                    check::<_, N>(element, &x, &format!("{thread:?} {name} {stretch} {bend}"));
                }
            }
        }
    }
}

#[test]
fn cables_follow_their_energy() {
    cables_of::<2>(&[STRAIGHT[0], STRAIGHT[1]]);
    cables_of::<3>(&STRAIGHT);
    cables_of::<3>(&BENT);
}

#[test]
fn a_cable_pulls_with_its_strain() {
    // T = EA (l - 1), energy = L T (l - 1)/2.
    let reference = [[0.0, 0.0, 0.0], [0.0, 3.0, 4.0]];
    let element = Cable::<2>::new(&reference, Thread::Elastic { stiffness: 25.0 }, 0.5).unwrap();
    let x = reference.map(|x| scaled(x, 1.2));
    let local = element.local(&x, PENALTY);
    assert!((local.energy - 0.5 * 5.0 * 0.5 * 25.0 * 0.04).abs() < 1e-14);
    assert!(
        (local.force[1][2] - 0.5 * 5.0 * 0.8).abs() < 1e-14
            && (local.force[1][1] - 0.5 * 5.0 * 0.6).abs() < 1e-14
    );
    let (tension, stretch) = element.tension(&x, PENALTY);
    assert!((tension - 5.0).abs() < 1e-13 && (stretch - 1.2).abs() < 1e-15);
    // After `hold`, T0 = EA (l - 1) is the tension at l = 1, and the measured value is the error of the
    // length.
    let mut element = Cable::<2>::new(&reference, Thread::Inextensible, 1.0).unwrap();
    let worst = element.hold(&x, PENALTY);
    assert!((worst - 0.2).abs() < 1e-15);
    let (tension, _) = element.tension(&reference, PENALTY);
    assert!((tension - 8.0).abs() < 1e-13);
    assert!((norm(element.local(&reference, PENALTY).force[1]) - 8.0).abs() < 1e-13);
    // In a slack thread T0 falls to zero.
    assert!(element.hold(&reference.map(|x| scaled(x, 0.7)), PENALTY).abs() < 1e-15);
    let (tension, _) = element.tension(&reference, PENALTY);
    assert!(tension.abs() < 1e-15);
}
