"""Messages: their values are expanded, their tags understood, and nothing of theirs gets out unescaped."""

import re
import time
from collections.abc import Callable
from html.parser import HTMLParser
from pathlib import Path

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from aircut import markup
from aircut.machine import Tool
from aircut.markup import Break, Bullet, Document, Item, List, Style, Text

EXAMPLES = Path(__file__).parent.parent.parent / "shared" / "spec" / "examples"
TOOLS = {1: Tool(1, "end mill", slot=2, diameter=6.0, z=50.25), 2: Tool(2), 3: Tool(3, "<B>odd</B> & #1")}

A_LIST = "<LI>List item 1\n<LI>List item 2\n<UL>\n<LI> Sub list item A\n<LI> Sub list item B\n</UL>\n<LI>List item 3\n"


def parse(text: str) -> Document:
    return markup.parse(text, TOOLS.get)


def plain(text: str) -> str:
    return markup.plain(parse(text))


def ansi(text: str) -> str:
    return markup.ansi(parse(text))


def html(text: str) -> str:
    return markup.html(parse(text)).replace('<ul style="list-style-type:disc">', "<ul>")


# --- tags


@pytest.mark.parametrize(
    ("tag", "style", "code", "opening"),
    [
        ("B", Style.BOLD, "1", "<b>"),
        ("U", Style.UNDERLINE, "4", "<u>"),
        ("I", Style.ITALIC, "3", "<i>"),
        ("S", Style.STRIKE, "9", "<s>"),
        ("SHAD", Style.SHADOW, "", '<span style="text-shadow:1px 1px 2px">'),
        ("HI", Style.HIGHLIGHT, "7", "<mark>"),
        ("E", Style.ERROR, "4;31", '<span style="text-decoration:underline wavy red">'),
    ],
)
def test_styles(tag: str, style: Style, code: str, opening: str) -> None:
    text = f"This is a <{tag}>test</{tag}>."
    assert parse(text) == Document((Text("This is a "), Text("test", style), Text(".")))
    assert parse(text.replace(tag, tag.lower())) == parse(text)
    assert plain(text) == "This is a test."
    assert ansi(text) == ("This is a " + (f"\x1b[{code}mtest\x1b[0m" if code else "test") + ".")
    assert html(text) == f"This is a {opening}test</{re.findall('[a-z]+', opening)[0]}>."


def test_styles_start_and_stop_and_need_not_nest() -> None:
    both = Style.BOLD | Style.ITALIC
    runs = (Text("a", Style.BOLD), Text("b", both), Text("c", Style.ITALIC), Text("d"))
    assert parse("<B>a<I>b</B>c</I>d").nodes == runs
    assert html("<B>a<I>b</B>c") == "<b>a</b><b><i>b</i></b><i>c</i>"
    assert parse("<B>a<B>b</B>c</B>d").nodes == (Text("abc", Style.BOLD), Text("d"))
    assert parse("</B>a</B><B>b").nodes == (Text("a"), Text("b", Style.BOLD))
    assert parse("<B>a<UL><LI>b</UL>c").nodes[-1] == Text("c", Style.BOLD)


def test_line_break() -> None:
    text = "This is a <BR> test"
    assert parse(text).nodes == (Text("This is a"), Break(), Text("test"))
    assert plain(text) == ansi(text) == "This is a\ntest"
    assert html(text) == "This is a<br>test"
    assert plain("a<br/><BR />b<BR>") == "a\n\nb"  # as on a page, a break at the end is no line
    assert plain("<I>a </I><B> </B><BR>b") == "a\nb"


def test_sub_and_sup() -> None:
    text = "This is<SUP>9</SUP>/<SUB>16</SUB>"
    assert parse(text).nodes == (Text("This is"), Text("9", Style.SUP), Text("/"), Text("16", Style.SUB))
    assert plain(text) == ansi(text) == "This is⁹/₁₆"
    assert html(text) == "This is<sup>9</sup>/<sub>16</sub>"
    assert plain("10<SUP>-3</SUP> x<SUB>max</SUB> m<SUP>a b</SUP>") == "10⁻³ x_(max) m^(a b)"


def test_lists() -> None:
    inner = List((Item((Text("Sub list item A"),)), Item((Text("Sub list item B"),))))
    items = (Item((Text("List item 1"),)), Item((Text("List item 2"), inner)), Item((Text("List item 3"),)))
    shown = "• List item 1\n• List item 2\n  • Sub list item A\n  • Sub list item B\n• List item 3"
    for text in (f"<UL>{A_LIST}</UL>", f"\n{A_LIST}</UL>\n", A_LIST, f"<ul>{A_LIST}".replace("\n", "</li>\n")):
        assert parse(text).nodes == (List(items),)
        assert plain(text) == ansi(text) == shown
    assert html(f"<UL>{A_LIST}</UL>") == (
        "<ul><li>List item 1</li><li>List item 2<ul><li>Sub list item A</li><li>Sub list item B</li></ul></li>"
        "<li>List item 3</li></ul>"
    )


@pytest.mark.parametrize(
    ("text", "shown"),
    [
        ("before <UL><LI>a<BR>more<LI>b</UL> after", "before\n• a\n  more\n• b\nafter"),
        ("a<BR><UL><LI>b</UL><BR>c", "a\n• b\n\nc"),
        ("<UL>title<LI>a<LI><LI>c</UL>", "  title\n• a\n•\n• c"),
        ("<UL><UL><LI>a</UL></UL>", "  • a"),
        ("a<UL></UL>b</UL>c", "abc"),
        ("<UL> <BR>", ""),
        ("<LI>a<BR><BR>b<LI>", "• a\n\n  b\n•"),
    ],
)
def test_odd_lists(text: str, shown: str) -> None:
    assert plain(text) == shown


def test_bullets() -> None:
    text = "<LI type=\"square\" color='RED'>a<LI COLOR=#0f8 Type=circle>b<LI type=circle>c<LI type=star color=url(x)>d"
    (items,) = parse(text).nodes
    assert isinstance(items, List)
    assert [(item.bullet, item.color) for item in items.items] == [
        (Bullet.SQUARE, "#ff0000"),
        (Bullet.CIRCLE, "#00ff88"),
        (Bullet.CIRCLE, None),
        (Bullet.DISC, None),
    ]
    assert plain(text) == "▪ a\n◦ b\n◦ c\n• d"
    assert ansi("<LI type=square color=clBlue>a") == "\x1b[38;2;0;0;255m▪\x1b[0m a"
    assert html("<LI type=circle>a") == '<ul><li style="list-style-type:circle">a</li></ul>'
    assert "color:#00ff88" in html(text)


@pytest.mark.parametrize(
    "color", ["", "red;x:y", "#12", "#12345g", "#1234567", "clnone", "expression(1)", "'", "var(--x)", "١", "cl"]
)
def test_what_is_no_color_leaves_the_bullet_as_it_is(color: str) -> None:
    assert html(f'<LI color="{color}">a') == "<ul><li>a</li></ul>"


def test_tool_tags() -> None:
    assert plain("<@TI=1>") == "T1 end mill, diameter 6 mm, length 50.25 mm, slot 2"
    assert plain("Insert <@td=1>!") == "Insert end mill!"
    assert plain("<@TI=2>|<@TD=2>") == "T2|"
    assert plain("<@TD = 1.0>, <@TD='+1'>") == "end mill, end mill"
    assert parse("<B><@TD=1></B>").nodes == (Text("end mill", Style.BOLD),)
    assert plain("a<@TI=9><@TD=9><@TI=><@TI=x><@TI=1.5><@TI=-1><@TI=null><@TI=######><@TI=" + "9" * 9999 + ">b") == "ab"
    assert markup.plain(markup.parse("a<@TI=1>b")) == "ab"
    assert plain("<TI=1> <@XX=1> <@TI> <@ TI=1>") == "<TI=1> <@XX=1> <@TI> <@ TI=1>"


def test_tool_tags_take_a_variable() -> None:
    text = markup.expand("Insert <@TD=#5134>", {"#5134": "1"}.get)
    assert plain(text) == "Insert end mill"


def test_a_tools_name_is_no_markup() -> None:
    assert plain("<@TD=3>") == "<B>odd</B> & #1"
    assert html("<@TD=3>") == "&lt;B&gt;odd&lt;/B&gt; &amp; #1"


@pytest.mark.parametrize(
    "text",
    [
        "if a < b and c > d",
        "<",
        "<B",
        "<>",
        "</>",
        "< B>",
        "<BOLD>x</BOLD>",
        "<S and S>",
        "<script>alert(1)</script>",
        '<B onclick="x"',
        "<@>",
        "</BR>",
        "&lt;B&gt; &amp; &#65;",
        "<ſ>",
        "a \n b ",
        " \r\v\f\x85\u2028 ",
    ],
)
def test_what_is_no_tag_is_text(text: str) -> None:
    assert parse(text).nodes == (Text(text),)
    assert plain(text) == text


def test_attributes_do_not_pass() -> None:
    assert html("<B onclick='x()' style=color:red>a</B>") == "<b>a</b>"
    assert html("<B onclick='a>b'>c") == "&lt;B onclick=&#x27;a&gt;b&#x27;&gt;c"
    assert html("<a href=x><img src=x>") == "&lt;a href=x&gt;&lt;img src=x&gt;"


def test_windows_without_tags_show_them() -> None:
    text = "<B>a</B><BR> <@TI=1>"
    document = markup.parse(text, TOOLS.get, tags=False)
    assert document.nodes == (Text(text),)
    assert markup.plain(document) == text
    assert markup.html(document) == "&lt;B&gt;a&lt;/B&gt;&lt;BR&gt; &lt;@TI=1&gt;"
    assert markup.parse("", tags=False) == markup.parse("") == Document(())


def test_terminal_commands_do_not_pass() -> None:
    assert ansi("a\x1b[2Jb\x9b1mc\td\r\x07") == "a�[2Jb�1mc\td��"
    assert ansi("<B>a\nb\n</B>\ud800") == "\x1b[1ma\x1b[0m\n\x1b[1mb\x1b[0m\n�"
    assert html("a\x00\ud800").encode() == "a��".encode()


@pytest.mark.skipif(not EXAMPLES.exists(), reason="the documents' examples are not at hand")
def test_documents_examples() -> None:
    program = (EXAMPLES / "message_tags.ngc").read_text("utf-8")
    assert [plain(text) for text in re.findall(r'P"([^"]*)"', program)] == [
        *["This is a test"] * 4,
        "This is a\ntest",
        "This is⁹/₁₆",
        "• List item 1\n• List item 2\n  • Sub list item A\n  • Sub list item B\n• List item 3",
        "shadow highlight error",
        "T1 end mill, diameter 6 mm, length 50.25 mm, slot 2 end mill",
    ]


@pytest.mark.skipif(not EXAMPLES.exists(), reason="the documents' examples are not at hand")
@pytest.mark.parametrize(
    ("file", "values", "shown"),
    [
        ("messages.ngc", {"#5001": "12.5"}, "The current value of the parameter 5001 is 12.5"),
        ("tool_change_length.ngc", {"#4010": "50"}, "Check tool length procedure has ended. Detected length is 50."),
        (
            "named_variables.ngc",
            {"#<array[#<_index>]>": "12", "#<array[#1+2]>": "34", "#<array[#1][2]>": "78"},
            "array[1]=12 array[2]=34 array[0][2]=78",
        ),
        (
            "named_variables.ngc",
            {"#<_variable2>": "456"},
            "Named parameter _variable2 exists and its value is 456.",
        ),
        ("null_parameter.ngc", {"#1": "null", "#0": "null"}, "IF[null EQ null] Should return TRUE"),
    ],
)
def test_documents_values(file: str, values: dict[str, str], shown: str) -> None:
    texts = re.findall(r'P"([^"]*)"', (EXAMPLES / file).read_text("utf-8"))
    assert shown in [plain(markup.expand(text, values.get)) for text in texts]


# --- values


@pytest.mark.parametrize(
    ("value", "shown"),
    [
        (None, "null"),
        (0.0, "0"),
        (-0.0, "0"),
        (12.0, "12"),
        (-100.0, "-100"),
        (2.5, "2.5"),
        (-0.125, "-0.125"),
        (1 / 3, "0.333333"),
        (0.1 + 0.2, "0.3"),
        (2.9999999999, "3"),
        (-1e-9, "0"),
        (1e-6, "0.000001"),
        (1e22, "10000000000000000000000"),
        (float("nan"), "nan"),
        (float("-inf"), "-inf"),
    ],
)
def test_number(value: float | None, shown: str) -> None:
    assert markup.number(value) == shown


@given(st.floats(-1e9, 1e9))
def test_a_number_reads_back(value: float) -> None:
    shown = markup.number(value)
    assert float(shown) == pytest.approx(value, abs=5.1e-7)
    assert re.fullmatch(r"-?\d+(\.\d{0,5}[1-9])?", shown)


def seen(text: str) -> list[str]:
    """The references in a text, as given to the evaluator."""
    found: list[str] = []
    markup.expand(text, found.append)
    return found


@pytest.mark.parametrize(
    ("text", "references"),
    [
        ("5730 #5730, #5731.", ["#5730", "#5731"]),
        ("T#1", ["#1"]),
        ("#1#2.5", ["#1", "#2"]),
        ("##7", ["#7"]),
        ("#<a>#<_args.b>", ["#<a>", "#<_args.b>"]),
        ("#< Some Name >.", ["#< Some Name >"]),
        ("#<a[#<b[1]>+[2*#3]][-1]>>", ["#<a[#<b[1]>+[2*#3]][-1]>"]),
        ("#<a[<i>]>", ["#<a[<i>]>"]),
        ("#<a[#<open> #<b>", ["#<open>", "#<b>"]),
        ("#<a]> #1", ["#1"]),
        ("#<a <B>#1", ["#1"]),
        ("#<a#1>", ["#1"]),
        ("# #x #[1] #<> #< > #<", []),
        ("#٣", []),
    ],
)
def test_where_references_end(text: str, references: list[str]) -> None:
    assert seen(text) == references


def test_expanding() -> None:
    values = {"#4010": "50", "#<x>": "#1 <B>"}
    assert markup.expand("#4010. #<x> #<gone> 100%", values.get) == "50. #1 <B> ###### 100%"
    assert markup.expand("", values.get) == ""
    assert markup.UNKNOWN == "######"


# --- any text

FRAGMENTS = st.sampled_from([
    "<", ">", "/", "#", "[", "]", "=", '"', "'", "&", ";", " ", "\n", "\x1b", "text", "<B>", "</B>", "<I>", "</I>",
    "<SUP>", "<SUB>", "</SUB>", "<E>", "</E>", "<HI>", "<BR>", "<UL>", "</UL>", "<LI>", "</LI>",
    "<LI type=square color=red>", "<LI color='", "onload=", "<script>", "<img src=x>", "javascript:", "<@TI=1>",
    "<@TD=3>", "<@T", "#<", "#1", "#<a[", "é",
])  # fmt: skip
texts = st.one_of(st.lists(FRAGMENTS).map("".join), st.text(), st.text(st.characters()))
OURS = {"b", "u", "i", "s", "sub", "sup", "mark", "span", "br", "ul", "li"}


class Page(HTMLParser):
    """What a browser would see."""

    def __init__(self) -> None:
        super().__init__(convert_charrefs=True)
        self.opened: list[str] = []
        self.said: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        assert tag in OURS
        for name, value in attrs:
            assert name in ("style", "aria-hidden"), name
            assert re.fullmatch(r"[a-z0-9:; #.-]*", value or "")
        if tag != "br":
            self.opened.append(tag)

    def handle_endtag(self, tag: str) -> None:
        assert self.opened.pop() == tag

    def handle_data(self, data: str) -> None:
        self.said.append(data)

    def handle_comment(self, data: str) -> None:
        raise AssertionError(data)

    def handle_decl(self, decl: str) -> None:
        raise AssertionError(decl)

    def handle_pi(self, data: str) -> None:
        raise AssertionError(data)


@given(texts)
@example(A_LIST)
@example("<LI color='red\"><script>'>")
@example("<LI color=#fff onload=x>")
def test_any_text_is_safe(text: str) -> None:
    document = parse(text)
    out = markup.html(document)
    assert re.sub(r"</?(b|u|i|s|sub|sup|mark|span|br|ul|li)( [a-z-]+=\"[^\"<>&]*\")*>", "", out).count("<") == 0
    page = Page()
    page.feed(out)
    page.close()
    assert page.opened == []
    out.encode()
    shown = markup.ansi(document)
    assert "\x1b" not in re.sub(r"\x1b\[[0-9;]*m", "", shown)
    shown.encode()
    markup.plain(document)
    hash(document)


@given(texts)
def test_text_without_tags_is_itself(text: str) -> None:
    text = text.replace("<", "")
    assert plain(text) == text
    literal = Document((Text(text),)) if text else Document(())
    assert parse(text) == literal == markup.parse(text, tags=False)


@given(texts)
def test_any_text_expands(text: str) -> None:
    same = markup.expand(text, lambda reference: reference)
    assert same == text
    for reference in seen(text):
        assert re.fullmatch(r"#[0-9]+|#<.*>", reference, re.DOTALL)
        assert reference.count("[") == reference.count("]")


# --- long text

LONG = 100_000  # characters


PIECES = [
    "<", ">", "<B>", "<B><I>", "</B>", "<B>x</B>y", "<B></B>x", "<UL>", "<UL><LI>", "<UL><LI>x", "<LI>x", "<UL></UL>",
    "</UL>", "<BR>", " <BR>", " ", "x", "<a", "<a ", "<B ", "<B a=", "<LI color=", "<LI a=b ", "a=b ", "a='b' ",
    "<@TI=", "<@TI=1>", "<E><HI><SUP><SUB>x</E>y</HI>z</SUP></SUB>", "#", "#<", "#<a[", "#<a[#1", "#<a[[", "#1",
    "#<a[]", "#<a[<", "[", "]", "#<a>", "#<>", "\n", "<LI>\n x",
]  # fmt: skip
WRAPPED = [
    "<{}", "<LI {}>", "<LI {}", "<LI a='{}'>", "#<a[{}", "#<a[{}]>", "#<a[#<b[{}", "<LI>{}", "<B>{}",
]  # fmt: skip


@pytest.mark.parametrize("shape", ["{}", *WRAPPED])
def test_long_text_takes_bounded_time(shape: str) -> None:
    length = LONG if shape == "{}" else LONG // 10
    for piece in PIECES:
        text = shape.replace("{}", piece * (length // len(piece)))
        started = time.perf_counter()
        markup.expand(text, lambda _: None)
        document = parse(text)
        renderers: list[Callable[[Document], str]] = [markup.plain, markup.ansi, markup.html]
        for render in renderers:
            assert len(render(document)) < 100 * LONG
        hash(document), repr(document)
        del document
        assert time.perf_counter() - started < 5.0, piece  # s; it takes a tenth
