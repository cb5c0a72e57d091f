//! Times of day and dates as instruments write them.

/// Seconds of a day.
const DAY: f64 = 86_400.0;
/// Seconds of an hour.
const HOUR: f64 = 3600.0;

/// A point in time: days since a fixed day (none if only the clock time is known), and seconds of the day.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Instant {
    day: Option<i64>,
    seconds: f64,
    /// Period after which a clock without a date starts again \[s\].
    round: f64,
}

/// Converts points in time into seconds since the first of them.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Clock {
    first: Option<Instant>,
    last: f64,
}

impl Clock {
    /// Seconds since the first one; none if only one of the two has a date.
    pub(crate) fn since_start(&mut self, now: Instant) -> Option<f64> {
        let first = *self.first.get_or_insert(now);
        let seconds = now.seconds - first.seconds;
        let time = match (first.day, now.day) {
            (Some(start), Some(day)) => (day - start) as f64 * DAY + seconds,
            (None, None) => {
                // Without a date, a step back by more than half a period is a wrap-around.
                let rounds = ((self.last - seconds) / now.round - 0.5).ceil().max(0.0);
                seconds + rounds * now.round
            }
            _ => return None,
        };
        self.last = time;
        Some(time)
    }
}

/// Reads "2026-03-01T12:00:01.5Z", "01.03.2026 12:00:01,5", "3/1/2026 1:02:03 PM", "12:00:01.5", "00:01:02",
/// and the "01:02.5" of spreadsheets, which leave out the hour.
pub(crate) fn instant(text: &str) -> Option<Instant> {
    let text = text.trim();
    if !text.contains(':') || text.len() > 40 {
        return None;
    }
    let (date, clock) = match text.find(['T', 't', ' ']) {
        Some(at) if text[..at].contains(['-', '/', '.']) => (Some(&text[..at]), text[at + 1..].trim()),
        _ => (None, text),
    };
    let day = date.map(days).map_or(Some(None), |day| day.map(Some))?;
    if let (None, Some(seconds)) = (day, seconds_of_hour(clock)) {
        return Some(Instant { day, seconds, round: HOUR });
    }
    let (clock, offset) = without_zone(clock)?;
    Some(Instant { day, seconds: seconds_of_day(clock)? - offset, round: DAY })
}

/// Minutes, and seconds with decimals; without decimals it would be hours and minutes.
fn seconds_of_hour(clock: &str) -> Option<f64> {
    let (minutes, seconds) = clock.split_once(':')?;
    let (whole_seconds, decimals) = seconds.split_once(['.', ','])?;
    let is_number = !decimals.is_empty() && decimals.bytes().all(|byte| byte.is_ascii_digit());
    let decimals = format!("0.{decimals}").parse::<f64>().ok().filter(|_| is_number)?;
    Some(60.0 * f64::from(whole(minutes, 9999)?) + f64::from(whole(whole_seconds, 59)?) + decimals)
}

/// The clock time without its time zone, and the zone in seconds.
fn without_zone(clock: &str) -> Option<(&str, f64)> {
    if let Some(utc) = clock.strip_suffix(['Z', 'z']) {
        return Some((utc.trim(), 0.0));
    }
    let Some(at) = clock.rfind(['+', '-']).filter(|at| *at > 0) else { return Some((clock, 0.0)) };
    let zone = &clock[at + 1..];
    let (hours, minutes) = match zone.split_once(':') {
        Some(parts) => parts,
        None if zone.len() == 4 && zone.is_ascii() => zone.split_at(2),
        None => (zone, "0"),
    };
    let offset = f64::from(whole(hours, 14)?) * 3600.0 + f64::from(whole(minutes, 59)?) * 60.0;
    Some((clock[..at].trim(), if clock[at..].starts_with('-') { -offset } else { offset }))
}

fn seconds_of_day(clock: &str) -> Option<f64> {
    let lower = clock.to_ascii_lowercase();
    let (clock, half) = match (lower.strip_suffix("am"), lower.strip_suffix("pm")) {
        (Some(clock), _) => (clock.trim(), Some(0)),
        (_, Some(clock)) => (clock.trim(), Some(12)),
        _ => (lower.as_str(), None),
    };
    let mut parts = clock.split(':');
    let (hours, minutes) = (whole(parts.next()?, 9999)?, whole(parts.next()?, 59)?);
    let seconds = parts.next().unwrap_or("0").replacen(',', ".", 1);
    // "12:00:01:500" has a separate field for milliseconds.
    let milliseconds = parts.next().map_or(Some(0), |text| whole(text, 999))?;
    let is_plain = seconds.starts_with(|c: char| c.is_ascii_digit());
    let seconds = seconds.parse::<f64>().ok().filter(|s| is_plain && (0.0..61.0).contains(s))?;
    if parts.next().is_some() {
        return None;
    }
    let hours = half.map_or(hours, |half| hours % 12 + half);
    Some(f64::from(hours) * 3600.0 + f64::from(minutes) * 60.0 + seconds + 1e-3 * f64::from(milliseconds))
}

/// Days since 1 March of the year 0.
fn days(date: &str) -> Option<i64> {
    let parts: Vec<&str> = date.split(['-', '/', '.']).collect();
    let [a, b, c] = parts.as_slice() else { return None };
    let number = |text: &str| whole(text, 9999).map(i64::from);
    let (first, second, third) = (number(a)?, number(b)?, number(c)?);
    let (year, month, day) = if a.len() == 4 {
        (first, second, third)
    } else if date.contains('/') && first <= 12 {
        // With slashes the month comes first, unless the number can't be a month.
        (third, first, second)
    } else {
        (third, second, first)
    };
    let year = if year < 100 { year + 2000 } else { year };
    if !(1..=12).contains(&month) || !(1..=31).contains(&day) {
        return None;
    }
    // A year that starts in March ends with the leap day.
    let shifted = (month + 9) % 12;
    let year = year - i64::from(month <= 2);
    Some(
        365 * year + year.div_euclid(4) - year.div_euclid(100)
            + year.div_euclid(400)
            + (153 * shifted + 2) / 5
            + day,
    )
}

fn whole(text: &str, most: u32) -> Option<u32> {
    let text = text.trim();
    let is_number = !text.is_empty() && text.len() <= 4 && text.bytes().all(|byte| byte.is_ascii_digit());
    text.parse().ok().filter(|number| is_number && *number <= most)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn seconds(texts: &[&str]) -> Vec<Option<f64>> {
        let mut clock = Clock::default();
        texts.iter().map(|text| clock.since_start(instant(text)?)).collect()
    }

    #[test]
    fn dates_and_clocks() {
        for texts in [
            ["2026-03-01T12:00:00.25Z", "2026-03-01T12:00:01.75Z"],
            ["2026-03-01 12:00:00.25", "2026-03-01 12:00:01.75"],
            ["2026-02-28T23:59:59.5+00:00", "2026-03-01T02:00:01+0200"],
            ["01.03.2026 12:00:00,25", "01.03.2026 12:00:01,75"],
            ["3/1/2026 12:59:59.5 PM", "3/1/2026 1:00:01 PM"],
            ["13/1/2026 12:00:00", "13/1/2026 12:00:01.5"],
            ["12:00:00.25", "12:00:01.75"],
            ["23:59:59.5", "00:00:01"],
            ["59:59.5", "00:01.0"],
            ["12:01,25", "12:02,75"],
            ["75:59.5", "76:01.0"],
            ["12:00:01:250", "12:00:02:750"],
        ] {
            assert_eq!(seconds(&texts), [Some(0.0), Some(1.5)], "{texts:?}");
        }
        assert_eq!(seconds(&["2024-02-28 00:00:00", "2024-03-01 00:00"]), [Some(0.0), Some(172_800.0)]);
        // A clock that goes back a little hasn't passed midnight.
        assert_eq!(seconds(&["12:00:10", "12:00:05"]), [Some(0.0), Some(-5.0)]);
        for text in
            ["12", "12:61:00", "a:b", "2026-13-01 12:00", "12:00:-1", "::", "12:00:00:00:00", "1:2:nan"]
        {
            assert_eq!(instant(text), None, "{text}");
        }
    }
}
