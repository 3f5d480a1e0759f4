"""What the checks share: the files under version control, and the prose in them."""
import os
import re
import subprocess

ROOT = os.path.dirname(os.path.dirname(os.path.dirname(os.path.abspath(__file__))))


def files(*suffixes):
    """Tracked and new files below the root that end in one of `suffixes`, or all."""
    out = subprocess.run(['git', 'ls-files', '-z', '--cached', '--others', '--exclude-standard'],
                         cwd=ROOT, check=True, capture_output=True, text=True).stdout
    names = sorted(set(out.split('\0')) - {''})
    return [n for n in names if (not suffixes or n.endswith(suffixes)) and os.path.isfile(os.path.join(ROOT, n))]


def text(name):
    with open(os.path.join(ROOT, name), encoding='utf-8') as f:
        return f.read()


# In order: raw strings, strings, characters (an apostrophe after a digit separates digits), comments.
TOKEN = re.compile(r'R"(?P<tag>[^()\s]*)\(.*?\)(?P=tag)"|"(?:\\.|[^"\\\n])*"|(?<![0-9A-Za-z])\'(?:\\.|[^\'\\\n])+\'|'
                   r'(?P<comment>//[^\n]*|/\*.*?\*/)', re.S)


def blank(match_text):
    """As many lines, nothing in them."""
    return re.sub(r'[^\n]', ' ', match_text)


def comments(source):
    """C++ source with all but its comments blanked."""
    out, last = [], 0
    for match in TOKEN.finditer(source):
        if match.group('comment'):
            out += [blank(source[last:match.start()]), match.group()]
            last = match.end()
    return ''.join(out) + blank(source[last:])


def prose(name):
    """The sentences of a file: comments of C++, Markdown without code; line numbers are kept."""
    content = text(name)
    if name.endswith('.md'):
        content = re.sub(r'^( *)(```|~~~).*?^ *\2', lambda m: blank(m.group()), content, flags=re.S | re.M)
    else:
        content = comments(content)
    return re.sub(r'`[^`\n]*`', lambda m: blank(m.group()), content)
