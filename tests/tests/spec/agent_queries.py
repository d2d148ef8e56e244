"""Matching and queries, as `spec/agents-semantics.md` defines them."""

from agent_values import OPEN, Fault, alike, apply, distinct, evaluate, fits, in_order, one_of, reads

DEPTH, STEPS = 100_000, 10_000_000


def form_of(data):
    """The name and the content of an enumeration's value in JSON: `"any"`, `{"var": 1}`."""
    if isinstance(data, str):
        return data, None
    ((form, of),) = data.items()
    return form, of


def well_bound(terms, theta, called):
    """A term may read only what is known, or bound by a term before it."""
    known = set(theta)

    def look(term):
        form, of = form_of(term)
        if form == "var":
            known.add(of)
        elif form == "list":
            for part in of[0] + ([of[1]] if of[1] else []):
                look(part)
        elif form == "expr":
            for name in reads(of):
                if name not in known:
                    raise Fault(f"`{called[name]}` has no value")

    for term in terms:
        look(term)


def match(term, value, theta, called=()):
    """θ ⊢ term = value ⇒ the result, or None."""
    form, of = form_of(term)
    if value is OPEN or form == "any":
        return theta
    if form == "var":
        if of not in theta:
            return theta | {of: value}
        return theta if alike(theta[of], value) else None
    if form == "expr":
        return theta if alike(evaluate(of, theta, called), value) else None
    elements, rest = of
    if not isinstance(value, tuple) or len(value) < len(elements) or (not rest and len(value) > len(elements)):
        return None
    theta = match_all(elements, value, theta, called)
    if theta is None or not rest:
        return theta
    return match(rest, value[len(elements) :], theta, called)


def match_all(terms, values, theta, called=()):
    """θ ⊢ (terms) = (values) ⇒ the result, or None."""
    for term, value in zip(terms, values):
        theta = match(term, value, theta, called)
        if theta is None:
            return None
    return theta


def match_annotations(terms, held, theta, called=()):
    """Each θ under which every annotation term matches one that is held: the earlier ones first."""
    if not terms:
        yield theta
        return
    (what, term), *others = terms
    for name, value in held:
        found = match(term, value, theta, called) if name == what else None
        if found is not None:
            yield from match_annotations(others, held, found, called)


def known(term, theta):
    """The value of a term, or OPEN while it has none."""
    form, of = form_of(term)
    if form == "any":
        return OPEN
    if form == "var":
        return theta.get(of, OPEN)
    if form == "expr":
        try:
            return evaluate(of, theta)
        except Fault:
            return OPEN
    elements = [known(part, theta) for part in of[0]]
    rest = known(of[1], theta) if of[1] else ()
    return OPEN if OPEN in elements or not isinstance(rest, tuple) else tuple(elements) + rest


def all_known(terms, theta):
    return [known(term, theta) for term in terms]


class Query:
    """One search over an agent's beliefs and rules."""

    def __init__(self, agent, called):
        self.agent, self.called, self.steps = agent, called, 0

    def count(self):
        self.steps += 1
        if self.steps > STEPS:
            raise Fault("the query takes too many steps")

    def answers(self, formula, theta, depth=0, called=None):
        """The answers of a formula, in order."""
        called = self.called if called is None else called
        form, of = form_of(formula)
        if form == "true":
            yield theta
        elif form == "belief":
            yield from self.literal(of, theta, depth, called)
        elif form == "not":
            if next(self.answers(of, theta, depth, called), None) is None:
                yield theta
        elif form == "and":
            yield from self.conjunction(of, theta, depth, called)
        elif form == "or":
            for part in of:
                yield from self.answers(part, theta, depth, called)
        elif form == "test":
            if evaluate(of, theta, called):
                yield theta
        elif form == "unify":
            yield from self.one(of[0], evaluate(of[1], theta, called), theta, called)
        else:
            yield from self.internal(of[0], theta, depth, called)

    def conjunction(self, parts, theta, depth, called):
        if not parts:
            yield theta
            return
        for found in self.answers(parts[0], theta, depth, called):
            yield from self.conjunction(parts[1:], found, depth, called)

    def one(self, term, value, theta, called):
        found = match(term, value, theta, called)
        if found is not None:
            yield found

    def literal(self, literal, theta, depth, called):
        """Facts from the oldest, then rules; with annotations facts alone."""
        well_bound(literal["args"] + [term for _, term in literal["annotations"]], theta, called)
        for fact in list(self.agent.beliefs[literal["belief"]]):
            self.count()
            found = match_all(literal["args"], fact.values, theta, called)
            if found is not None:
                yield from match_annotations(literal["annotations"], fact.annotations, found, called)
        if not literal["annotations"]:
            for values in self.derived(literal["belief"], all_known(literal["args"], theta), depth):
                found = match_all(literal["args"], values, theta, called)
                if found is not None:
                    yield found

    def derived(self, belief, asked, depth):
        """The values that the rules of a belief give, in order."""
        for rule in self.agent.it["rules"]:
            if rule["belief"] != belief:
                continue
            self.count()
            if depth >= DEPTH:
                raise Fault("rules call each other too deeply")
            theta = enter(rule["args"], asked, rule["vars"])
            if theta is None:
                continue
            for found in self.answers(rule["body"], theta, depth + 1, rule["vars"]):
                # What was asked with has been matched on entering, but for what could not be worked out then.
                if match_all(rule["args"], asked, found, rule["vars"]) is not None:
                    yield [head(term, found, rule["vars"]) for term in rule["args"]]

    def instances(self, belief, asked):
        """The values of facts and of answers of rules that a pattern admits."""
        for fact in list(self.agent.beliefs[belief]):
            self.count()
            if fits(asked, fact.values):
                yield fact.values
        for values in self.derived(belief, asked, 0):
            if fits(asked, values):
                yield values

    def internal(self, action, theta, depth, called):
        """An internal action that asks, in the place of a belief."""
        form, of = form_of(action)
        value = lambda e: evaluate(e, theta, called)
        if form == "find_all":
            found = [evaluate(of["template"], t, called) for t in self.answers(of["formula"], theta, depth, called)]
            yield from self.one(of["out"], in_order(distinct(found)) if of["set"] else tuple(found), theta, called)
        elif form == "count":
            number = sum(1 for _ in self.answers(of["formula"], theta, depth, called))
            yield from self.one(of["out"], number, theta, called)
        elif form == "member":
            for element in one_of(value(of["list"]), tuple):
                yield from self.one(of["element"], element, theta, called)
        elif form in ("apply", "holds"):
            result = apply(of["function"], [value(e) for e in of["args"]])
            if form == "apply" and result is not None:
                yield from self.one(of["out"], result, theta, called)
            elif form == "holds" and result:
                yield theta
        elif form in ("intend", "desire", "suspended"):
            for values in self.agent.pursued(form, of["goal"]):
                found = match_all(of["args"], values, theta, called)
                if found is not None:
                    yield found
        elif form in ("time", "my_name", "all_names"):
            company = self.agent.company
            result = {
                "time": company.now / 10**9,
                "my_name": self.agent.name,
                "all_names": tuple(a.name for a in company.agents),
            }[form]
            yield from self.one(of["out"], result, theta, called)
        else:
            raise NotImplementedError(f".{form}")


def enter(terms, asked, called):
    """What the variables of a rule's head get from the values asked with; None if they do not match. Terms that
    cannot be worked out yet are compared when the body has an answer."""
    theta = {}
    for term, value in zip(terms, asked):
        form, of = form_of(term)
        if form == "expr" and not set(reads(of)) <= set(theta):
            continue
        theta = match(term, value, theta, called)
        if theta is None:
            return None
    return theta


def head(term, theta, called):
    """The value of an argument of a rule's head."""
    form, of = form_of(term)
    return evaluate(of, theta, called) if form == "expr" else known(term, theta)


def variables(literal):
    """The variables that a literal's arguments and annotations may bind."""
    out = []

    def look(term):
        form, of = form_of(term)
        if form == "var":
            out.append(of)
        elif form == "list":
            for part in of[0] + ([of[1]] if of[1] else []):
                look(part)

    for term in literal["args"] + [term for _, term in literal["annotations"]]:
        look(term)
    return out
