//! The command table: every command of the language, once.
//!
//! The parser takes from it how many arguments a command has and what they are called, the checks of `lower` which values
//! are legal, the help texts what to say. Adding a command begins here.

/// Names a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum CommandKind {
    /// `fov`
    Fov,
    /// `background`
    Background,
    /// `light`
    Light,
    /// `surface`
    Surface,
    /// `sphere`
    Sphere,
    /// `cylinder`
    Cylinder,
    /// `write`
    Write,
}

/// What an argument counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// A length or a coordinate, in world units.
    World,
    /// An angle in degrees.
    Degrees,
    /// A channel of a colour, or the share of light that a surface returns.
    Share,
    /// An exponent, without unit.
    Exponent,
    /// A file name.
    FileName,
}

impl Unit {
    /// Returns the unit in words, for help texts.
    #[must_use]
    pub const fn words(self) -> &'static str {
        match self {
            Self::World => "world units",
            Self::Degrees => "degrees",
            Self::Share => "0 to 1",
            Self::Exponent => "exponent",
            Self::FileName => "file name",
        }
    }
}

/// The values that an argument may have. All numbers are finite.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Range {
    /// Any number.
    Any,
    /// Any number, but one outside 0…1 is probably a mistake.
    UsuallyUnit,
    /// Above 0.
    Positive,
    /// 0 or above.
    NotNegative,
    /// Above 0 and below this.
    PositiveBelow(f64),
}

impl Range {
    /// Tells whether a scene may hold `value` here.
    #[must_use]
    pub fn allows(self, value: f64) -> bool {
        match self {
            Self::Any | Self::UsuallyUnit => true,
            Self::Positive => value > 0.0,
            Self::NotNegative => value >= 0.0,
            Self::PositiveBelow(limit) => value > 0.0 && value < limit,
        }
    }

    /// Tells whether `value` is one that scenes usually hold here.
    #[must_use]
    pub fn expects(self, value: f64) -> bool {
        match self {
            Self::UsuallyUnit => (0.0..=1.0).contains(&value),
            // An angle in degrees below this is probably one in radians.
            Self::PositiveBelow(_) => self.allows(value) && value > std::f64::consts::PI,
            Self::Any | Self::Positive | Self::NotNegative => self.allows(value),
        }
    }
}

/// One argument of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ArgSpec {
    /// Its name in help texts and messages.
    pub name: &'static str,
    /// What it counts.
    pub unit: Unit,
    /// The values it may have.
    pub range: Range,
    /// What it means, in a few words.
    pub doc: &'static str,
}

/// Numbers of one command, side by side, that mean one thing together. Formatting sets them apart from the next group.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Group {
    /// What formulas and editors call it, in one short word.
    pub symbol: &'static str,
    /// What it is, in words.
    pub name: &'static str,
    /// How many numbers it has.
    pub n_numbers: usize,
    /// Whether they are red, green and blue.
    pub is_color: bool,
}

/// What follows the name of a command.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Arguments {
    /// This many numbers.
    Numbers(&'static [ArgSpec]),
    /// One file name.
    FileName(&'static ArgSpec),
}

/// One command of the language.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CommandSpec {
    /// Which command this is.
    pub kind: CommandKind,
    /// Its name in a scene.
    pub name: &'static str,
    /// What follows the name.
    pub arguments: Arguments,
    /// The numbers by meaning, from the first to the last.
    pub groups: &'static [Group],
    /// Two numbers, by index, of which the first must be below the second.
    pub rising: Option<(usize, usize)>,
    /// What it does, a sentence.
    pub doc: &'static str,
    /// A line of a scene that shows it.
    pub example: &'static str,
}

impl CommandSpec {
    /// Returns the arguments that are numbers; none for `write`.
    #[must_use]
    pub const fn numbers(&self) -> &'static [ArgSpec] {
        match self.arguments {
            Arguments::Numbers(args) => args,
            Arguments::FileName(_) => &[],
        }
    }

    /// Returns the groups of its numbers, each with the indices of those it has.
    pub fn grouped(&self) -> impl DoubleEndedIterator<Item = (std::ops::Range<usize>, &'static Group)> + use<> {
        let end_of = |i: usize, groups: &[Group]| groups[..=i].iter().map(|group| group.n_numbers).sum::<usize>();
        let groups = self.groups;
        groups.iter().enumerate().map(move |(i, group)| {
            let end = end_of(i, groups);
            (end - group.n_numbers..end, group)
        })
    }

    /// Returns the names of the arguments.
    pub fn arg_names(&self) -> impl Iterator<Item = &'static str> + use<> {
        let args: &'static [ArgSpec] = match &self.arguments {
            Arguments::Numbers(args) => args,
            Arguments::FileName(arg) => std::slice::from_ref(*arg),
        };
        args.iter().map(|arg| arg.name)
    }

    /// Returns the command as one writes it down: its name and those of its arguments.
    #[must_use]
    pub fn usage(&self) -> String {
        self.arg_names().fold(self.name.to_owned(), |usage, name| usage + " " + name)
    }
}

impl CommandKind {
    /// Returns the entry of the command table.
    #[must_use]
    pub const fn spec(self) -> &'static CommandSpec {
        &COMMANDS[self as usize]
    }

    /// Returns the name in a scene.
    #[must_use]
    pub const fn name(self) -> &'static str {
        self.spec().name
    }
}

/// Returns the command of this name, if there is one.
#[must_use]
pub fn find(name: &str) -> Option<&'static CommandSpec> {
    COMMANDS.iter().find(|command| command.name == name)
}

/// The most numbers that a command takes.
pub const MAX_NUMBERS: usize = 11;

pub(super) const fn world(name: &'static str, doc: &'static str) -> ArgSpec {
    ArgSpec { name, unit: Unit::World, range: Range::Any, doc }
}

pub(super) const fn share(name: &'static str, doc: &'static str) -> ArgSpec {
    ArgSpec { name, unit: Unit::Share, range: Range::UsuallyUnit, doc }
}

const fn group(symbol: &'static str, name: &'static str, n_numbers: usize) -> Group {
    Group { symbol, name, n_numbers, is_color: false }
}

const fn color(symbol: &'static str, name: &'static str) -> Group {
    Group { symbol, name, n_numbers: 3, is_color: true }
}

pub(super) const RADIUS: ArgSpec =
    ArgSpec { name: "radius", unit: Unit::World, range: Range::Positive, doc: "the radius" };

/// Every command, in the order of [`CommandKind`].
pub static COMMANDS: [CommandSpec; 7] = [
    CommandSpec {
        kind: CommandKind::Fov,
        name: "fov",
        arguments: Arguments::Numbers(&[ArgSpec {
            name: "angle",
            unit: Unit::Degrees,
            range: Range::PositiveBelow(180.0),
            doc: "from the lower to the upper edge of the image",
        }]),
        groups: &[group("angle", "the angle of view", 1)],
        rising: None,
        doc: "Sets the vertical field of view.",
        example: "fov 60",
    },
    CommandSpec {
        kind: CommandKind::Background,
        name: "background",
        arguments: Arguments::Numbers(&[share("r", "red"), share("g", "green"), share("b", "blue")]),
        groups: &[color("rgb", "the colour")],
        rising: None,
        doc: "Sets the colour of a ray that meets nothing; black until set.",
        example: "background 0.2 0.3 0.5",
    },
    CommandSpec {
        kind: CommandKind::Light,
        name: "light",
        arguments: Arguments::Numbers(&[
            share("r", "red"),
            share("g", "green"),
            share("b", "blue"),
            world("x", "to the right"),
            world("y", "up"),
            world("z", "towards the viewer"),
        ]),
        groups: &[color("Cl", "the colour"), group("position", "the position", 3)],
        rising: None,
        doc: "Adds a point light: its colour, then its position.",
        example: "light 1 1 1   0 0 5",
    },
    CommandSpec {
        kind: CommandKind::Surface,
        name: "surface",
        arguments: Arguments::Numbers(&[
            share("Car", "ambient red"),
            share("Cag", "ambient green"),
            share("Cab", "ambient blue"),
            share("Cdr", "diffuse red"),
            share("Cdg", "diffuse green"),
            share("Cdb", "diffuse blue"),
            share("Csr", "specular red"),
            share("Csg", "specular green"),
            share("Csb", "specular blue"),
            ArgSpec { name: "P", unit: Unit::Exponent, range: Range::NotNegative, doc: "the shininess" },
            share("Krefl", "the weight of the mirror image"),
        ]),
        groups: &[
            color("Ca", "the ambient colour"),
            color("Cd", "the diffuse colour"),
            color("Cs", "the specular colour"),
            group("P", "the shininess", 1),
            group("Krefl", "the reflectance", 1),
        ],
        rising: None,
        doc: "Sets the surface of the objects that follow.",
        example: "surface 0.1 0 0   0.8 0.2 0.2   0.5 0.5 0.5   20   0.3",
    },
    CommandSpec {
        kind: CommandKind::Sphere,
        name: "sphere",
        arguments: Arguments::Numbers(&[
            world("x", "the centre, to the right"),
            world("y", "the centre, up"),
            world("z", "the centre, towards the viewer"),
            RADIUS,
        ]),
        groups: &[group("centre", "the centre", 3), group("radius", "the radius", 1)],
        rising: None,
        doc: "Adds a sphere.",
        example: "sphere 0 0 -4   1",
    },
    CommandSpec {
        kind: CommandKind::Cylinder,
        name: "cylinder",
        arguments: Arguments::Numbers(&[
            RADIUS,
            world("x", "the axis, to the right"),
            world("z", "the axis, towards the viewer"),
            world("ymin", "the height of the lower cap"),
            world("ymax", "the height of the upper cap, above ymin"),
        ]),
        groups: &[
            group("radius", "the radius", 1),
            group("axis", "the place of the axis", 2),
            group("heights", "the heights of the caps", 2),
        ],
        rising: Some((3, 4)),
        doc: "Adds a closed vertical cylinder.",
        example: "cylinder 0.5   0 -4   -1 1",
    },
    CommandSpec {
        kind: CommandKind::Write,
        name: "write",
        arguments: Arguments::FileName(&ArgSpec {
            name: "name.png",
            unit: Unit::FileName,
            range: Range::Any,
            doc: "the image, below the output folder",
        }),
        groups: &[],
        rising: None,
        doc: "Renders the scene as it now stands and saves the image.",
        example: "write picture.png",
    },
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_table_is_indexed_by_kind() {
        for (i, command) in COMMANDS.iter().enumerate() {
            assert_eq!(command.kind as usize, i);
            assert!(std::ptr::eq(command.kind.spec(), command));
            assert!(command.numbers().len() <= MAX_NUMBERS);
            let grouped: Vec<usize> = command.grouped().flat_map(|(numbers, _)| numbers).collect();
            assert_eq!(grouped, Vec::from_iter(0..command.numbers().len()), "the groups of {}", command.name);
            for (numbers, group) in command.grouped() {
                assert!(!group.is_color || command.numbers()[numbers].iter().all(|arg| arg.unit == Unit::Share));
            }
        }
    }
}
