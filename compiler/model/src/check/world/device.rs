//! Devices: the commands of each kind, checked against the primitives of the world, and the rules that wait for them.

use hrdsl_ir::world::DeviceId;
use hrdsl_ir::{
    ListOf,
    device::{
        CommandParam, CommandType, DeviceBody, DeviceCommand, DeviceKind, DeviceMeasure, DevicePrimitive,
        DeviceSort, Expectation, NumberCount, PrimitiveParam,
    },
};
use hrdsl_syntax::ast::{self, DeviceMemberKind as Member, ItemSyntaxKind, NameSyntax};

use crate::check::{
    checker::Checker,
    state::{table::OrderedMap, template::TemplateArgument},
};
use crate::resolution::type_span;
use crate::{
    ArmId, BaseId, GripperId, InferredType, LaserId, Type,
    noun::Noun,
    report::{devices, names},
    types::TypeLayout,
    world::TypedRuleTrigger,
};

impl<'a> Checker<'a> {
    /// All kinds of devices with the commands that are declared for them, the library's first.
    pub(in crate::check) fn devices(&mut self) {
        let kind = |sort: DeviceSort| DeviceKind {
            name: sort.name().to_owned(),
            doc: String::new(),
            sort,
            commands: Vec::new(),
        };
        self.s.device_kinds = DeviceSort::ALL.map(kind).into();
        let mut known = OrderedMap::default();
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
                let Member::Command(command) = &member.kind else { continue };
                let checked = self.device_command(sort, command, &member.doc);
                let Some(sort) = sort else { continue };
                let name = &command.name;
                if let Some(first) = known.get(&(sort.name(), name.text.as_str())) {
                    let issue = names::duplicate(Noun::Command, &name.text, name.span, Some(*first));
                    self.report(issue);
                    continue;
                }
                known.insert((sort.name(), name.text.as_str()), name.span);
                self.s.places.commands.insert((sort.name(), name.text.clone()), name.span);
                self.kind_mut(sort).commands.extend(checked);
            }
        }
    }

    fn kind_mut(&mut self, sort: DeviceSort) -> &mut DeviceKind {
        let at = DeviceSort::ALL.iter().position(|s| *s == sort).unwrap_or(0);
        &mut self.s.device_kinds[at]
    }

    fn device_kind(&self, sort: DeviceSort) -> Option<&DeviceKind> {
        self.s.device_kinds.iter().find(|kind| kind.sort == sort)
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
        let own = || DevicePrimitive::ALL.into_iter().filter(|p| p.sort() == sort).map(DevicePrimitive::name);
        let issue = match DevicePrimitive::named(&name.text) {
            Some(primitive) if primitive.sort() == sort => return Some(primitive),
            Some(primitive) => devices::of_another(name, noun_of(primitive.sort()), noun_of(sort), own()),
            None => names::unknown(Noun::Primitive, &name.text, name.span, own()),
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

    // ── Rules ──

    /// `on close robot.grip`
    pub(in crate::check) fn commanded(
        &mut self,
        command: &NameSyntax,
        device: &ast::PathSyntax,
        prefix: &str,
    ) -> Option<TypedRuleTrigger> {
        let knows = |kind: &&DeviceKind| kind.command(&command.text).is_some();
        let knowing: Vec<DeviceSort> = self.s.device_kinds.iter().filter(knows).map(|k| k.sort).collect();
        let Some(body) = self.device_of(device, &knowing, prefix) else {
            if knowing.is_empty() && !self.source.unread_items {
                let all: Vec<DeviceKind> = self.s.device_kinds.clone();
                let all = all.iter().flat_map(|kind| &kind.commands).map(|c| c.name.as_str());
                self.report(names::unknown(Noun::Command, &command.text, command.span, all));
            }
            return None;
        };
        let place = self.s.places.commands.get(&(body.sort().name(), command.text.clone())).copied();
        let kind = self.device_kind(body.sort())?;
        if let Some(id) = kind.command(&command.text) {
            self.refer(command, place);
            return Some(TypedRuleTrigger::Commanded { device: body, command: id });
        }
        let all = kind.commands.iter().map(|c| c.name.as_str());
        let issue = devices::cannot(command, &kind.with_article(), all);
        if !self.source.unread_items {
            self.report(issue);
        }
        None
    }

    /// The device that a path names; if there is none, one of these sorts was meant.
    pub(in crate::check) fn device_of(
        &mut self,
        path: &ast::PathSyntax,
        meant: &[DeviceSort],
        prefix: &str,
    ) -> Option<DeviceBody> {
        // A parameter stands for what it is declared to be.
        if let [only] = path.names.as_slice()
            && let Some(TemplateArgument::Thing(is, _)) = self.given(&only.text)
        {
            let is = *is;
            let sort = DeviceSort::ALL.into_iter().find(|sort| noun_of(*sort) == is);
            let id = self.world_name(if sort.is_some() { is } else { Noun::Device }, &path.names, prefix)?;
            return sort.map(|sort| body(sort, id));
        }
        let full = self.full_name(&path.names, prefix)?;
        for sort in DeviceSort::ALL {
            if let Some(id) = self.world.names.get(noun_of(sort), &full) {
                self.refer_in_world(noun_of(sort), &path.names, &full);
                return Some(body(sort, id));
            }
        }
        let noun = if let [only] = meant { noun_of(*only) } else { Noun::Device };
        self.world_name(noun, &path.names, prefix);
        None
    }
}

impl Checker<'_> {
    /// Its place among all devices of the world.
    pub(in crate::check) fn device_id(&self, body: DeviceBody) -> DeviceId {
        self.s.world.as_ref().map_or(DeviceId(0), |world| world.device_id(body))
    }
}

fn body(sort: DeviceSort, id: u16) -> DeviceBody {
    match sort {
        DeviceSort::Arm => DeviceBody::Arm(ArmId(id)),
        DeviceSort::Gripper => DeviceBody::Gripper(GripperId(id)),
        DeviceSort::Base => DeviceBody::Base(BaseId(id)),
        DeviceSort::Laser => DeviceBody::Laser(LaserId(id)),
    }
}

fn noun_of(sort: DeviceSort) -> Noun {
    match sort {
        DeviceSort::Arm => Noun::Arm,
        DeviceSort::Gripper => Noun::Gripper,
        DeviceSort::Base => Noun::Base,
        DeviceSort::Laser => Noun::Laser,
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
