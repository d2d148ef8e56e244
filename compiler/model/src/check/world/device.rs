//! Devices: the commands and states of each kind, checked against the primitives of the world.

use hrdsl_ir::{
    ListOf,
    device::{
        CommandParam, CommandType, DeclaredState, DeviceCommand, DeviceKind, DeviceMeasure, DevicePrimitive,
        DeviceSort, Expectation, NumberCount, PrimitiveParam,
    },
    device_state::DeviceState,
};
use hrdsl_syntax::ast::{self, DeviceMemberKind as Member, ItemSyntaxKind, NameSyntax};

use crate::check::value::devices::noun_of;
use crate::check::{template::CheckerPhase, world::phase::WorldPhase};
use crate::resolution::type_span;
use crate::{
    InferredType, Type,
    noun::Noun,
    report::{devices, names},
    types::TypeLayout,
};

impl<'a> WorldPhase<'_, 'a> {
    /// All kinds of devices with the commands and states that are declared for them, the library's first.
    pub(in crate::check) fn devices(&mut self) {
        let kind = |sort: DeviceSort| DeviceKind {
            name: sort.name().to_owned(),
            doc: String::new(),
            sort,
            commands: Vec::new(),
            states: Vec::new(),
        };
        self.s.device_kinds = DeviceSort::ALL.map(kind).into();
        for item in self.source.items.clone() {
            let ItemSyntaxKind::Device(device) = &item.kind else { continue };
            let sort = self.device_sort(&device.kind);
            if let Some(sort) = sort {
                let kind = self.kind_mut(sort);
                if kind.doc.is_empty() {
                    kind.doc.clone_from(&item.doc);
                }
            }
            for member in &device.members {
                match &member.kind {
                    Member::Command(command) => {
                        let checked = self.device_command(sort, command, &member.doc);
                        let Some(sort) = sort else { continue };
                        if self.is_first(Noun::Command, sort, &command.name) {
                            self.kind_mut(sort).commands.extend(checked);
                        }
                    }
                    Member::State(state) => {
                        let Some(sort) = sort else { continue };
                        let checked = self.device_state(sort, state, &member.doc);
                        if self.is_first(Noun::DeviceState, sort, &state.name) {
                            self.kind_mut(sort).states.extend(checked);
                        }
                    }
                    Member::Error => {}
                }
            }
        }
    }

    /// Whether no command, or no state, of these devices has the name yet; reports it otherwise.
    fn is_first(&mut self, noun: Noun, sort: DeviceSort, name: &NameSyntax) -> bool {
        let places = &mut self.s.places;
        let known = if noun == Noun::Command { &mut places.commands } else { &mut places.states };
        let key = (sort.name(), name.text.clone());
        let first = known.get(&key).copied();
        match first {
            Some(_) => self.report(names::duplicate(noun, &name.text, name.span, first)),
            None => drop(known.insert(key, name.span)),
        }
        first.is_none()
    }

    /// `state joints from joint_angles`
    fn device_state(
        &mut self,
        sort: DeviceSort,
        state: &ast::DeviceStateSyntax,
        doc: &str,
    ) -> Option<DeclaredState> {
        let own = DeviceState::ALL.into_iter().filter(|s| s.sort() == sort).map(DeviceState::name);
        let found = DeviceState::named(&state.told.text).map(|told| (told, told.sort()));
        let told = self.of_sort(sort, &state.told, found, own)?;
        Some(DeclaredState { name: state.name.text.clone(), doc: doc.to_owned(), told })
    }

    fn kind_mut(&mut self, sort: DeviceSort) -> &mut DeviceKind {
        let at = DeviceSort::ALL.iter().position(|s| *s == sort).unwrap_or(0);
        &mut self.s.device_kinds[at]
    }

    fn device_sort(&mut self, kind: &NameSyntax) -> Option<DeviceSort> {
        let words = DeviceSort::ALL.map(DeviceSort::name);
        self.choice(Noun::DeviceKind, kind, &words).map(|at| DeviceSort::ALL[at])
    }

    /// `command close do close_fingers expect holds else "…"`; without a `sort`, of a kind of devices that there is not.
    fn device_command(
        &mut self,
        sort: Option<DeviceSort>,
        command: &ast::DeviceCommandSyntax,
        doc: &str,
    ) -> Option<DeviceCommand> {
        let params: Vec<ast::ParamSyntax> = command.params.iter().map(|p| p.param.clone()).collect();
        let layouts = self.fields(&params);
        let sort = sort?;
        let expect = command.expect.as_ref().map(|e| self.expectation(sort, e));
        let primitive = self.primitive(sort, &command.primitive)?;
        let mut checked = Vec::new();
        for (param, (name, layout)) in command.params.iter().zip(layouts.iter()) {
            let Some(takes) = primitive.params().iter().find(|p| p.name == name) else {
                let all = primitive.params().iter().map(|p| p.name);
                self.report(devices::not_taken(primitive.name(), &param.param.name, all));
                continue;
            };
            self.command_param(primitive, takes, param, layout);
            checked.push(CommandParam { name: name.clone(), ty: takes.ty, optional: param.optional });
        }
        for needed in primitive.params().iter().filter(|p| !p.optional) {
            if !params.iter().any(|p| p.name.text == needed.name) {
                let ty = type_text(needed.ty);
                self.report(devices::missing(primitive.name(), needed.name, &ty, &command.name));
            }
        }
        Some(DeviceCommand {
            name: command.name.text.clone(),
            doc: doc.to_owned(),
            params: checked,
            primitive,
            expect: expect.flatten(),
        })
    }

    fn primitive(&mut self, sort: DeviceSort, name: &NameSyntax) -> Option<DevicePrimitive> {
        let own = DevicePrimitive::ALL.into_iter().filter(|p| p.sort() == sort).map(DevicePrimitive::name);
        let found = DevicePrimitive::named(&name.text).map(|primitive| (primitive, primitive.sort()));
        self.of_sort(sort, name, found, own)
    }

    /// What was found under a name, if it is of this sort of device; `own` are the names that there are.
    fn of_sort<P>(
        &mut self,
        sort: DeviceSort,
        name: &NameSyntax,
        found: Option<(P, DeviceSort)>,
        own: impl Iterator<Item = &'static str>,
    ) -> Option<P> {
        let issue = match found {
            Some((primitive, of)) if of == sort => return Some(primitive),
            Some((_, of)) => devices::of_another(name, noun_of(of), noun_of(sort), own),
            None => names::unknown(Noun::Primitive, &name.text, name.span, own),
        };
        self.report(issue);
        None
    }

    /// Whether the parameter is what the primitive takes.
    fn command_param(
        &mut self,
        primitive: DevicePrimitive,
        takes: &PrimitiveParam,
        param: &ast::CommandParamSyntax,
        layout: &TypeLayout,
    ) {
        let ast::ParamSyntax { name, ty } = &param.param;
        if *layout != TypeLayout::Unknown && *layout != layout_of(takes.ty) {
            let got = self.shown_layout(layout);
            self.report(devices::other_type(
                primitive.name(),
                &name.text,
                &type_text(takes.ty),
                &got,
                type_span(ty),
            ));
        }
        if param.optional && !takes.optional {
            self.report(devices::needed(primitive.name(), name));
        }
    }

    fn expectation(&mut self, sort: DeviceSort, expect: &ast::ExpectationSyntax) -> Option<Expectation> {
        let own: Vec<DeviceMeasure> = DeviceMeasure::ALL.into_iter().filter(|m| m.sort() == sort).collect();
        let Some(measure) = own.iter().find(|m| m.name() == expect.measure.text) else {
            let name = &expect.measure;
            let near = own.iter().map(|m| m.name());
            self.report(names::unknown(Noun::DeviceMeasure, &name.text, name.span, near));
            return None;
        };
        Some(Expectation { measure: *measure, is: !expect.negated, otherwise: expect.otherwise.text.clone() })
    }
}

fn layout_of(ty: CommandType) -> TypeLayout {
    let element = Type::Float(ty.unit);
    match ty.count {
        NumberCount::One => TypeLayout::Scalar(element),
        NumberCount::Array(n) => TypeLayout::Array(Box::new(TypeLayout::Scalar(element)), n),
        NumberCount::List => TypeLayout::Scalar(Type::List(ListOf::new(element))),
    }
}

/// As it is declared: `length[3]`.
fn type_text(ty: CommandType) -> String {
    let element = InferredType::of(Type::Float(ty.unit));
    match ty.count {
        NumberCount::One => element.type_name(),
        NumberCount::Array(n) => format!("{}[{n}]", element.type_name()),
        NumberCount::List => InferredType::list(element).type_name(),
    }
}
