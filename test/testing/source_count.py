"""Counts what mechanisms are made of in a C++ text: for test/ratchet_test.py.

This is no parser. It reads the text as clang-format leaves it, after comments, literals of text and
lines for the preprocessor were taken out, and counts what stands there whether it is built or not.
"""

import re

SKIPPED = re.compile(
    r'//[^\n]*|/\*.*?\*/'                          # comments
    r'|R"(?P<end>[^(\s]*)\(.*?\)(?P=end)"'         # raw strings
    r'|"(?:\\.|[^"\\\n])*"'                        # strings
    r"|(?<![\w'])'(?:\\.|[^'\\\n])+'"              # characters, not the ' within a number
    r"|^[ \t]*#(?:\\\n|[^\n])*", re.DOTALL | re.MULTILINE)
# "const double " before a name of a constant.
DECLARATION = re.compile(
    r"\bconst(?:expr)?\s+(?P<type>(?:[\w:]+(?:<[^;={}]*>)?[\s*&]+)+?)(?=k[A-Z])")
# "kName = ", "kNames[] = ", "kName" before a brace.
DECLARATOR = re.compile(r"\s*(k[A-Z]\w*)\s*(?:\[[^\]]*\]\s*)*(?:=(?!=)|(?=\{))")
NUMBER = re.compile(r"(?<![\w.])\.?\d")
OF_NUMBERS = re.compile(
    r"\b(?:u?int\d+_t|int|unsigned|long|short|s?size_t|ptrdiff_t|Index|float|double|auto)\b")
OF_NO_NUMBERS = re.compile(r"\b(?:char|bool|string|string_view)\b")
CLASS = re.compile(r"\b(enum\s+)?(class|struct)\s+(\w+)(?:\s+final)?\s*(?::(?!:)[^;{}()]*)?\{")
ACCESS = re.compile(r"\s*(public|protected|private)\s*:(?!:)")
NO_METHOD = re.compile(r"(?:using|typedef|friend|static_assert|enum|class|struct|union)\b")


def code_of(text):
    """The text without comments and lines for the preprocessor, strings and characters empty."""
    def replacement(match):
        first = match.group().lstrip()[0]
        return "''" if first == "'" else '""' if first in 'R"' else " "

    return SKIPPED.sub(replacement, text)


def end_of(code, start, stops):
    """The place of the first of these characters, from the start on, outside all brackets."""
    depth = 0
    for place in range(start, len(code)):
        character = code[place]
        if depth == 0 and character in stops:
            return place
        depth += (character in "([{") - (character in ")]}")
    return len(code)


def is_numeric(type_text, value):
    if '"' in value or OF_NO_NUMBERS.search(type_text) or value.lstrip().startswith("["):
        return False
    return bool(OF_NUMBERS.search(type_text) or NUMBER.search(value))


def places_in_classes(code, places):
    """Which of these places, in ascending order, stand directly in the body of a class."""
    bodies = {match.end() - 1 for match in CLASS.finditer(code) if not match[1]}
    inside, stack, at = set(), [], 0
    for place in places:
        for brace in re.finditer(r"[{}]", code[at:place]):
            if brace.group() == "{":
                stack.append(at + brace.start() in bodies)
            elif stack:
                stack.pop()
        at = place
        if stack and stack[-1]:
            inside.add(place)
    return inside


def numeric_constants(text):
    """(names, names in classes) of the constants that hold a number, numbers, or an expression of
    numbers: the first of namespaces and functions, the second members of classes, both in the order
    of the text. A table of numbers is one constant."""
    code = code_of(text)
    declarations = list(DECLARATION.finditer(code))
    members = places_in_classes(code, [declaration.start() for declaration in declarations])
    names = ([], [])
    for declaration in declarations:
        place = declaration.end()
        while declarator := DECLARATOR.match(code, place):
            end = end_of(code, declarator.end(), ",;)")
            if is_numeric(declaration["type"], code[declarator.end():end]):
                names[declaration.start() in members].append(declarator[1])
            if code[end:end + 1] != ",":
                break
            place = end + 1
    return names


def branches_on(text, enumerations, predicates=()):
    """The places, as they stand there, at which a text asks for a kind: a comparison with an
    enumerator, a switch over enumerators, the use of a function or variable that stands for such a
    comparison. What declares or sets the latter is none."""
    code = code_of(text)
    enumerator = rf"(?:\w+::)*\b(?:{'|'.join(enumerations)})::k\w+"
    patterns = [rf"[=!]=\s*{enumerator}", rf"{enumerator}\s*[=!]=", rf"\{{\s*case\s+{enumerator}"]
    patterns += [rf"(?<!\bbool )\b{name}\(" if name[0].isupper() else
                 rf"(?<!\bbool )\b{name}\b(?!\s*(?:\(|=[^=]))" for name in predicates]
    found = [match for pattern in patterns for match in re.finditer(pattern, code)]
    return [" ".join(match.group().strip("{(").split())
            for match in sorted(found, key=lambda match: match.start())]


def after_body(body, place):
    """The place after a function's body that begins with the brace at this place, or after what its
    constructor initialises with braces before."""
    while True:
        place = end_of(body, place + 1, "}") + 1
        following = re.compile(r"\s*(?:,[^{]*)?\{").match(body, place)
        if not following:
            return place
        place = following.end() - 1


def public_members(body, access):
    """The declarations in the body of a class that are public, without the bodies of functions."""
    place = 0
    while place < len(body):
        if label := ACCESS.match(body, place):
            access, place = label[1], label.end()
            continue
        end = end_of(body, place, ";{")
        declaration = body[place:end].strip()
        if access == "public":
            yield declaration
        if body[end:end + 1] == "{" and "(" in declaration and not NO_METHOD.match(declaration):
            place = after_body(body, end)
        elif body[end:end + 1] == "{":  # braces of a value or of a nested class
            place = end_of(body, end_of(body, end + 1, "}") + 1, ";") + 1
        else:
            place = end + 1


def is_method(declaration, of_class):
    plain = re.sub(r"\balignas\([^()]*\)|\[\[[^\]]*\]\]|->", "", declaration)
    while (shorter := re.sub(r"<[^<>]*>", "", plain)) != plain:
        plain = shorter
    head, bracket, _ = plain.partition("(")
    if not bracket or NO_METHOD.match(plain) or re.search(r"\boperator=$", head):
        return False
    if "=" in head and "operator" not in head:  # a field with its value
        return False
    return not re.search(rf"(?:^|[\s~]){of_class}\s*$", head)


def public_methods(text):
    """{class or struct: number of its public methods}, overloads one by one, without constructors,
    destructors and assignments. Nested classes stand for themselves."""
    code = code_of(text)
    numbers = {}
    for match in CLASS.finditer(code):
        if match[1]:
            continue
        body = code[match.end():end_of(code, match.end(), "}")]
        access = "public" if match[2] == "struct" else "private"
        number = sum(is_method(member, match[3]) for member in public_members(body, access))
        numbers[match[3]] = max(number, numbers.get(match[3], 0))
    return numbers
