"""The fastest command without vibration in several modes."""
