"""The service: shots, frames and focus over HTTP. ``service.app.create_app`` makes the application."""
