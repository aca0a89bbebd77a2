"""Answers for an assistant: the tools of `fem-seal mcp`, within one folder."""
