"""Pictures of a shot: one frame, a moving one, a long exposure, a contact sheet, progressive pictures."""
