//! A value of a settings file by its type.

use std::ops::Range;
use toml::de::DeValue;

use super::Setting;

impl<'a> Setting<'a> {
    /// Its place.
    #[must_use]
    pub fn span(self) -> Range<usize> {
        self.value.span()
    }

    /// The text, if it is one.
    #[must_use]
    pub fn text(self) -> Option<&'a str> {
        self.value.get_ref().as_str()
    }

    /// A number with its unit; a bare number goes the same way, and the message says which unit is missing.
    #[must_use]
    pub fn number(self) -> Option<&'a str> {
        match self.value.get_ref() {
            DeValue::String(text) => Some(text.as_ref()),
            // The digits of 0x10 would read as ten.
            DeValue::Integer(number) if number.radix() == 10 => Some(number.as_str()),
            DeValue::Float(number) => Some(number.as_str()),
            _ => None,
        }
    }

    /// A whole number that is not negative.
    #[must_use]
    pub fn whole(self) -> Option<u64> {
        match self.value.get_ref() {
            DeValue::Integer(number) => u64::from_str_radix(number.as_str(), number.radix()).ok(),
            _ => None,
        }
    }

    /// The items, if it is a list.
    #[must_use]
    pub fn items(self) -> Option<Vec<Self>> {
        match self.value.get_ref() {
            DeValue::Array(items) => Some(items.iter().map(|value| Self { value }).collect()),
            _ => None,
        }
    }

    /// The keys and values, if it is a table.
    #[must_use]
    pub fn entries(self) -> Option<Vec<(&'a str, Self)>> {
        match self.value.get_ref() {
            DeValue::Table(table) => {
                Some(table.iter().map(|(key, value)| (key.get_ref().as_ref(), Self { value })).collect())
            }
            _ => None,
        }
    }

    /// Its type in words, such as "a number".
    #[must_use]
    pub fn type_name(self) -> &'static str {
        match self.value.get_ref() {
            DeValue::String(_) => "text",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        }
    }
}
