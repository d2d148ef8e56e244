"""Names that tools do not show."""


def topic_or_service_is_hidden(name: str) -> bool:
    """Whether a part of the name begins with an underscore."""
    return any(token.startswith("_") for token in name.split("/"))
