"""The service: shots, frames and focus over HTTP. ``service.http.app.create_app`` makes the application."""
