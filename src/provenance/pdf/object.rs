//! Objects of a PDF (ISO 32000-1, clause 7.3).

use std::{cell::Cell, collections::BTreeSet};

use super::Broken;

/// Maximum nesting of arrays and dictionaries; a report has four levels.
const DEEPEST: usize = 32;
/// Number of bytes of a string that count as one object.
const TEXT: usize = 64;

#[derive(Clone, Debug, PartialEq)]
pub enum Object {
    Null,
    Integer(i64),
    Name(Vec<u8>),
    Text(Vec<u8>),
    Array(Vec<Object>),
    Dict(Dict),
    /// The number of another object.
    Reference(u32),
    Real(f64),
    Boolean(bool),
}

#[derive(Clone, Debug, Default, PartialEq)]
pub struct Dict(Vec<(Vec<u8>, Object)>);

impl Dict {
    /// The first value of a key, as other readers use it.
    pub fn get(&self, key: &str) -> Option<&Object> {
        self.0.iter().find(|(known, _)| known == key.as_bytes()).map(|(_, value)| value)
    }

    pub fn iter(&self) -> impl Iterator<Item = (&[u8], &Object)> {
        self.0.iter().map(|(key, value)| (key.as_slice(), value))
    }

    /// Whether each key is one of these.
    pub fn only(&self, keys: &[&str]) -> bool {
        self.iter().all(|(key, _)| keys.iter().any(|known| known.as_bytes() == key))
    }

    /// Whether both have the same values, but of some keys.
    pub fn same_but(&self, other: &Self, keys: &[&str]) -> bool {
        let rest = |one: &Self| {
            let kept = |(key, _): &&(Vec<u8>, Object)| {
                !keys.iter().any(|known| known.as_bytes() == key.as_slice())
            };
            let mut rest: Vec<_> = one.0.iter().filter(kept).cloned().collect();
            rest.sort_by(|(one, _), (other, _)| one.cmp(other));
            rest
        };
        rest(self) == rest(other)
    }

    /// Adds the keys and values of another dictionary that this one lacks.
    pub fn fill(&mut self, other: Self) {
        for (key, value) in other.0 {
            if !self.0.iter().any(|(known, _)| *known == key) {
                self.0.push((key, value));
            }
        }
    }
}

impl Object {
    pub fn integer(&self) -> Option<usize> {
        if let Self::Integer(value) = self { usize::try_from(*value).ok() } else { None }
    }

    /// Whether no dictionary in it has a key twice, of which readers take one or the other.
    pub fn is_unique(&self) -> bool {
        match self {
            Self::Array(all) => all.iter().all(Self::is_unique),
            Self::Dict(Dict(entries)) => {
                let keys: BTreeSet<&[u8]> = entries.iter().map(|(key, _)| key.as_slice()).collect();
                keys.len() == entries.len() && entries.iter().all(|(_, value)| value.is_unique())
            }
            _ => true,
        }
    }

    pub fn is_name(&self, name: &str) -> bool {
        matches!(self, Self::Name(found) if found == name.as_bytes())
    }
}

/// Parses objects from a position. Every object reduces the budget, which bounds the time.
#[derive(Debug)]
pub struct Parser<'a> {
    pub bytes: &'a [u8],
    pub at: usize,
    pub budget: &'a Cell<usize>,
}

pub fn is_space(byte: u8) -> bool {
    matches!(byte, 0 | b'\t' | b'\n' | 0x0c | b'\r' | b' ')
}

fn is_delimiter(byte: u8) -> bool {
    matches!(byte, b'(' | b')' | b'<' | b'>' | b'[' | b']' | b'{' | b'}' | b'/' | b'%')
}

impl Parser<'_> {
    fn peek(&self) -> Option<u8> {
        self.bytes.get(self.at).copied()
    }

    pub fn space(&mut self) {
        while let Some(byte) = self.peek() {
            if byte == b'%' {
                while self.peek().is_some_and(|byte| byte != b'\n' && byte != b'\r') {
                    self.at += 1;
                }
            } else if is_space(byte) {
                self.at += 1;
            } else {
                return;
            }
        }
    }

    /// Skips a word, if it is at the current position.
    pub fn word(&mut self, word: &str) -> bool {
        self.space();
        let here = self.bytes.get(self.at..).is_some_and(|rest| rest.starts_with(word.as_bytes()));
        if here {
            self.at += word.len();
        }
        here
    }

    pub fn integer(&mut self) -> Result<usize, Broken> {
        match self.object(0)? {
            Object::Integer(value) => {
                usize::try_from(value).map_err(|_| Broken("a number is below zero"))
            }
            _ => Err(Broken("a number is missing")),
        }
    }

    pub fn object(&mut self, depth: usize) -> Result<Object, Broken> {
        if depth > DEEPEST {
            return Err(Broken("its objects are nested too deeply"));
        }
        self.spend(1)?;
        self.space();
        let start = self.at;
        match self.peek().ok_or(Broken("it ends in the middle of an object"))? {
            b'/' => {
                let name = self.name();
                self.spend((self.at - start) / TEXT)?;
                Ok(Object::Name(name))
            }
            b'(' => {
                let text = self.literal()?;
                self.spend((self.at - start) / TEXT)?;
                Ok(Object::Text(text))
            }
            b'[' => {
                self.at += 1;
                let mut all = Vec::new();
                while !self.word("]") {
                    all.push(self.object(depth + 1)?);
                }
                Ok(Object::Array(all))
            }
            b'<' if self.bytes.get(self.at + 1) == Some(&b'<') => {
                self.at += 2;
                let mut dict = Dict::default();
                while !self.word(">>") {
                    let Object::Name(key) = self.object(depth + 1)? else {
                        return Err(Broken("a key of a dictionary is not a name"));
                    };
                    dict.0.push((key, self.object(depth + 1)?));
                }
                Ok(Object::Dict(dict))
            }
            b'<' => {
                let text = self.hexadecimal()?;
                self.spend((self.at - start) / TEXT)?;
                Ok(Object::Text(text))
            }
            b'+' | b'-' | b'.' | b'0'..=b'9' => self.number(),
            _ => {
                let known = [
                    ("true", Object::Boolean(true)),
                    ("false", Object::Boolean(false)),
                    ("null", Object::Null),
                ];
                let found = known.into_iter().find(|(word, _)| self.word(word));
                found.map(|(_, object)| object).ok_or(Broken("it contains an invalid object"))
            }
        }
    }

    fn spend(&self, objects: usize) -> Result<(), Broken> {
        self.budget.set(
            self.budget.get().checked_sub(objects).ok_or(Broken("its structure is too large"))?,
        );
        Ok(())
    }

    fn token(&mut self) -> &[u8] {
        let start = self.at;
        while self.peek().is_some_and(|byte| !is_space(byte) && !is_delimiter(byte)) {
            self.at += 1;
        }
        &self.bytes[start..self.at]
    }

    fn number(&mut self) -> Result<Object, Broken> {
        let token = String::from_utf8_lossy(self.token()).into_owned();
        let Ok(value) = token.parse::<i64>() else {
            return token
                .parse::<f64>()
                .map(Object::Real)
                .map_err(|_| Broken("it contains an invalid number"));
        };
        // `12 0 R` is a reference, `12 0 1` are three numbers.
        let after = self.at;
        self.space();
        if self.token().iter().all(u8::is_ascii_digit) && self.word("R") {
            return u32::try_from(value)
                .map(Object::Reference)
                .map_err(|_| Broken("a reference leads nowhere"));
        }
        self.at = after;
        Ok(Object::Integer(value))
    }

    fn name(&mut self) -> Vec<u8> {
        self.at += 1;
        let token = self.token();
        let mut name = Vec::new();
        let mut rest = token;
        while let [first, more @ ..] = rest {
            let escaped = if *first == b'#' {
                more.get(..2).and_then(|two| hex(two[0]).zip(hex(two[1])))
            } else {
                None
            };
            match escaped {
                Some((high, low)) => {
                    name.push(high << 4 | low);
                    rest = &more[2..];
                }
                None => {
                    name.push(*first);
                    rest = more;
                }
            }
        }
        name
    }

    fn hexadecimal(&mut self) -> Result<Vec<u8>, Broken> {
        self.at += 1;
        let mut digits = Vec::new();
        loop {
            let byte = self.peek().ok_or(Broken("it ends in the middle of a text"))?;
            self.at += 1;
            match hex(byte) {
                Some(digit) => digits.push(digit),
                None if byte == b'>' => break,
                None if is_space(byte) => {}
                None => return Err(Broken("a text contains an invalid hexadecimal digit")),
            }
        }
        Ok(digits.chunks(2).map(|pair| pair[0] << 4 | pair.get(1).unwrap_or(&0)).collect())
    }

    fn literal(&mut self) -> Result<Vec<u8>, Broken> {
        self.at += 1;
        let mut text = Vec::new();
        let mut inner = 0_usize;
        loop {
            let byte = self.peek().ok_or(Broken("it ends in the middle of a text"))?;
            self.at += 1;
            match byte {
                b'\\' => {
                    self.escape(&mut text);
                    continue;
                }
                b'(' => inner += 1,
                b')' if inner == 0 => return Ok(text),
                b')' => inner -= 1,
                _ => {}
            }
            text.push(byte);
        }
    }

    fn escape(&mut self, text: &mut Vec<u8>) {
        let Some(byte) = self.peek() else { return };
        self.at += 1;
        match byte {
            b'n' => text.push(b'\n'),
            b'r' => text.push(b'\r'),
            b't' => text.push(b'\t'),
            b'b' => text.push(8),
            b'f' => text.push(12),
            b'\n' => {}
            b'\r' => self.at += usize::from(self.peek() == Some(b'\n')),
            b'0'..=b'7' => {
                let mut value = u32::from(byte - b'0');
                for _ in 0..2 {
                    let Some(digit @ b'0'..=b'7') = self.peek() else { break };
                    value = value * 8 + u32::from(digit - b'0');
                    self.at += 1;
                }
                text.push((value & 0xff) as u8);
            }
            other => text.push(other),
        }
    }
}

fn hex(byte: u8) -> Option<u8> {
    char::from(byte).to_digit(16).and_then(|digit| u8::try_from(digit).ok())
}
