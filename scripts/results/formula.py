"""Values of the formulas of a .prm, as muParser gives them to slipstick: x, y, t, pi, ^, &&, ||, a ? b : c and functions."""

import ast
import math
import operator

FUNCTIONS = {name: getattr(math, name) for name in ("sin", "cos", "tan", "asin", "acos", "atan", "sinh", "cosh", "tanh",
                                                     "asinh", "acosh", "atanh", "exp", "sqrt", "log10", "log2", "atan2")}
FUNCTIONS.update({"ln": math.log, "log": math.log, "abs": abs, "min": min, "max": max, "rint": round,
                  "sign": lambda x: (x > 0) - (x < 0), "sum": lambda *x: sum(x), "avg": lambda *x: sum(x) / len(x)})
OPERATORS = {ast.Add: operator.add, ast.Sub: operator.sub, ast.Mult: operator.mul, ast.Div: operator.truediv,
             ast.Pow: operator.pow, ast.USub: operator.neg, ast.UAdd: operator.pos, ast.Lt: operator.lt,
             ast.Gt: operator.gt, ast.LtE: operator.le, ast.GtE: operator.ge, ast.Eq: operator.eq, ast.NotEq: operator.ne}


def value(text, x=0., y=0., t=1.):
    """The number, or None for a formula that is not understood here."""
    try:
        names = {"x": x, "y": y, "t": t, "pi": math.pi, "_pi": math.pi, "_e": math.e}
        return float(evaluated(ast.parse(translated(text), mode="eval").body, names))
    except (SyntaxError, KeyError, TypeError, ValueError, ZeroDivisionError, OverflowError, RecursionError):
        return None


def translated(text):
    """Into the words of Python; a ? b : c becomes (b if a else c), at every level of parentheses."""
    text = text.strip().replace("^", "**").replace("&&", " and ").replace("||", " or ")
    depth, question = 0, None
    for i, character in enumerate(text):
        depth += (character == "(") - (character == ")")
        if depth == 0 and character == "?" and question is None:
            question = i
    if question is not None:
        depth, nested = 0, 0
        for i in range(question + 1, len(text)):
            depth += (text[i] == "(") - (text[i] == ")")
            if depth == 0 and text[i] == "?":
                nested += 1
            elif depth == 0 and text[i] == ":":
                if nested == 0:
                    yes, no = text[question + 1:i], text[i + 1:]
                    return f"(({translated(yes)}) if ({translated(text[:question])}) else ({translated(no)}))"
                nested -= 1
    result, start = "", 0
    while True:  # the insides of parentheses, where there may be more
        opening = text.find("(", start)
        if opening < 0:
            return result + text[start:]
        depth, closing = 1, opening
        while depth:
            closing += 1
            depth += (text[closing:closing + 1] == "(") - (text[closing:closing + 1] == ")")
            if closing >= len(text):
                raise ValueError("parentheses")
        inside = text[opening + 1:closing]
        result += text[start:opening] + "(" + (translated(inside) if "?" in inside else inside) + ")"
        start = closing + 1


def evaluated(node, names):
    if isinstance(node, ast.Constant) and isinstance(node.value, (int, float)):
        return node.value
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.BinOp):
        return OPERATORS[type(node.op)](evaluated(node.left, names), evaluated(node.right, names))
    if isinstance(node, ast.UnaryOp):
        return OPERATORS[type(node.op)](evaluated(node.operand, names))
    if isinstance(node, ast.Compare) and len(node.ops) == 1:
        return OPERATORS[type(node.ops[0])](evaluated(node.left, names), evaluated(node.comparators[0], names))
    if isinstance(node, ast.BoolOp):
        values = [bool(evaluated(part, names)) for part in node.values]
        return all(values) if isinstance(node.op, ast.And) else any(values)
    if isinstance(node, ast.IfExp):
        return evaluated(node.body if evaluated(node.test, names) else node.orelse, names)
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name) and not node.keywords:
        return FUNCTIONS[node.func.id](*(evaluated(part, names) for part in node.args))
    raise TypeError(type(node).__name__)
